//! Serves the dashboard with the toy robot of the tests, to work on the dashboard alone.

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let port = std::env::args().nth(1).map_or(Ok(0), |port| port.parse())?;
    let lab = rumbo_station::serve(
        rumbo_station::LabConfig { port, speed: 1.0 },
        Box::new(support::Toy::default()),
    )?;
    println!("{}", lab.url());
    Ok(lab.wait()?)
}
