//! Serves the dashboard with the toy robot of the tests, to work on the dashboard alone.

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let config = rumbo_station::LabConfig {
        at: rumbo_station::ServeAt::here(0),
        ..rumbo_station::LabConfig::default()
    };
    let lab = rumbo_station::serve(config, Box::new(support::Toy::default()))?;
    println!("{}", lab.url());
    Ok(lab.wait()?)
}
