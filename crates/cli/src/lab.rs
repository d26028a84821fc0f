//! `rumbo lab`: a simulated robot behind the station's dashboard.

use crate::args::LabArgs;
use crate::failure::Failure;
use crate::logs;
use crate::manifest;
use crate::output;
use crate::scene::{first_commands, scene};
use rumbo_control::Wheels;
use rumbo_scenario::files::{FileError, Library, Overrides, Setup};
use rumbo_scenario::run;
use rumbo_scenario::sim::Sim;
use rumbo_station::log::{Kind, Manifest, Recording};
use rumbo_station::{Choice, LabConfig, MapPose, Scene, Simulation, Target, Truth};
use rumbo_wire::Command;
use std::io::Write;

/// Serves the dashboard, prints its address first thing, and opens the browser.
pub(crate) fn lab(args: &LabArgs) -> Result<(), Failure> {
    let choice = Choice {
        scenario: args.scenario.clone(),
        world: args.world.clone(),
        rig: args.rig.clone(),
        seed: args.seed,
    };
    let robot = SimulatedRobot::new(args.robot.clone(), choice).map_err(Failure::input)?;
    let config = LabConfig {
        port: args.port,
        speed: args.speed,
        recording: logs::folder(args.out.as_deref()).map(|folder| Recording { folder }),
    };
    let lab = rumbo_station::serve(config, Box::new(robot)).map_err(Failure::input)?;
    output::line(lab.url())?;
    if !args.no_browser && open::that_detached(lab.url()).is_err() {
        // The address is on stdout; nobody may be reading stderr.
        let _ = writeln!(
            std::io::stderr(),
            "no browser could be opened; open the address above yourself"
        );
    }
    lab.wait().map_err(Failure::Input)
}

/// The simulation as the station drives it.
struct SimulatedRobot {
    library: Library,
    /// Robot instead of the scenario's own.
    robot: Option<String>,
    sim: Sim,
    manifest: Manifest,
    scene: Scene,
    first_commands: Vec<Command>,
}

impl SimulatedRobot {
    fn new(robot: Option<String>, choice: Choice) -> Result<Self, FileError> {
        let library = Library::new();
        let (sim, mut scene, first_commands, manifest) = prepare(&library, robot.clone(), choice)?;
        offer(&mut scene.scenarios, Some(&scene.choice.scenario));
        offer(&mut scene.worlds, scene.choice.world.as_ref());
        Ok(Self {
            library,
            robot,
            sim,
            manifest,
            scene,
            first_commands,
        })
    }
}

/// Adds a path from the command line to the names to choose from.
fn offer(names: &mut Vec<String>, chosen: Option<&String>) {
    if let Some(chosen) = chosen.filter(|chosen| !names.contains(chosen)) {
        names.push(chosen.clone());
    }
}

/// A simulation at time 0 and what surrounds it.
fn prepare(
    library: &Library,
    robot: Option<String>,
    choice: Choice,
) -> Result<(Sim, Scene, Vec<Command>, Manifest), FileError> {
    let overrides = Overrides {
        robot,
        world: choice.world.clone(),
        rig: choice.rig.clone(),
        ..Overrides::default()
    };
    let setup: Setup = library.setup(&choice.scenario, &overrides)?;
    let manifest = manifest::of(Kind::Lab, &setup, &overrides, choice.seed);
    let setup = setup.of_seed(choice.seed)?;
    let sim = Sim::new(&*run::prepare(&setup, choice.seed)?, choice.seed)?;
    let scene = scene(library, &setup, choice)?;
    Ok((sim, scene, first_commands(&setup), manifest))
}

impl Target for SimulatedRobot {
    fn now_us(&self) -> u64 {
        self.sim.now_us()
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), String> {
        self.sim.advance(self.sim.now_us() + dt_us);
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.sim.send(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.sim.receive(into);
    }

    fn baud(&self) -> u32 {
        self.sim.baud()
    }

    fn manifest(&self) -> Manifest {
        self.manifest.clone()
    }

    fn simulation(&mut self) -> Option<&mut dyn Simulation> {
        Some(self)
    }
}

impl Simulation for SimulatedRobot {
    fn truth(&self) -> Truth {
        let truth = self.sim.truth();
        let [left, right] = truth.wheel_rad_s;
        Truth {
            pose: MapPose {
                x_m: truth.pose.x_m,
                y_m: truth.pose.y_m,
                heading_rad: truth.pose.heading_rad,
            },
            wheel_rad_s: Wheels { left, right },
            range_m: truth.range_m,
            servo_rad: truth.servo_rad,
            contact: truth.touching,
            battery_v: truth.battery_v,
        }
    }

    fn scene(&self) -> Scene {
        self.scene.clone()
    }

    fn first_commands(&self) -> Vec<Command> {
        self.first_commands.clone()
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), String> {
        // The page chooses among names it was given; it opens no files.
        let Scene {
            scenarios, worlds, ..
        } = &self.scene;
        let offered = scenarios.contains(&choice.scenario)
            && choice.world.iter().all(|world| worlds.contains(world));
        if !offered {
            return Err("no such scenario or world here; choose one of the list".into());
        }
        let fresh = prepare(&self.library, self.robot.clone(), choice.clone());
        let (sim, scene, first_commands, manifest) = fresh.map_err(|error| error.to_string())?;
        // What the command line added to the lists stays there.
        let Scene {
            scenarios, worlds, ..
        } = std::mem::take(&mut self.scene);
        (self.sim, self.first_commands, self.manifest, self.scene) = (
            sim,
            first_commands,
            manifest,
            Scene {
                scenarios,
                worlds,
                ..scene
            },
        );
        Ok(())
    }
}
