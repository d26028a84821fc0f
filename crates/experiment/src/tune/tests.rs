use super::*;
use crate::files::{Kind, Library, Overrides};

fn setup(scenario: &str, parameters: &[(&str, f64)]) -> Setup {
    let parameters = parameters
        .iter()
        .map(|(name, value)| ((*name).to_owned(), *value));
    let overrides = Overrides {
        parameters: parameters.collect(),
        ..Overrides::default()
    };
    Library::new().setup(scenario, &overrides).unwrap()
}

fn over(names: &[&str]) -> Vec<Over> {
    let one = |text: &&str| match text.split_once('=') {
        None => Over::Name(ParamId::from_name(text).unwrap()),
        Some((name, _)) => Over::Range(ParamId::from_name(name).unwrap(), text.parse().unwrap()),
    };
    names.iter().map(one).collect()
}

#[test]
fn ranges_lie_about_the_start_and_within_the_limits() {
    let setup = setup("mode1", &[("front_kp", 15.0)]);
    let all = tuned(&setup, &over(&["front_kp", "kv=0.01:0.1", "speed_kd_left"])).unwrap();
    let [front_kp, kv, kd] = &all[..] else {
        panic!()
    };
    assert_eq!((front_kp.start, front_kp.range), (15.0, [1.875, 20.0]));
    assert_eq!(
        (kv.range, kv.at(-1.0), kv.at(1.0)),
        ([0.01, 0.1], 0.01, 0.1)
    );
    assert!((kv.at(0.0) - 0.03162).abs() < 1e-9);
    assert_eq!((kd.start, kd.range, kd.at(0.0)), (0.0, [0.0, 1.0], 0.5));
    for one in &all {
        assert!((one.at(one.place(one.start)) - one.start).abs() < 1e-9);
    }
}

#[test]
fn what_cannot_be_tuned_is_named() {
    let setup = setup("mode1", &[]);
    for (names, why) in [
        (&["front_kp", "front_kp=1:2"][..], "given twice"),
        (&["waypoint_tracker"], "switch or a choice"),
        (&["front_kp=1:30"], "must lie within 0.1..20"),
        (&["front_kp=1,2"], "FROM:TO"),
    ] {
        let said = tuned(&setup, &over(names)).unwrap_err().to_string();
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn from_a_fifth_of_its_gain_a_robot_keeps_its_limits_once_more_on_robots_not_seen() {
    // The recorded robot's gain is 6: with 1 it needs 3.3 s, and the limit is 2.4 s.
    let setup = setup("mode1", &[("front_kp", 1.0)]);
    let over = tuned(&setup, &over(&["front_kp"])).unwrap();
    let objective = "settling_s".parse().unwrap();
    let search = |seed| Search {
        setup: &setup,
        over: &over,
        objective: &objective,
        seed,
        budget: 3_000,
    };
    let found = search(1).run(|_| (), &|| true).unwrap();
    assert_eq!(found, search(1).run(|_| (), &|| true).unwrap());
    assert!(found.runs < 4_000, "{}", found.runs);
    let tuned = search(1).setup_of(&found.values).unwrap();
    let passes = |setup: &Setup| {
        let seeds = Search::SEEDS..Search::SEEDS + 30;
        seeds.filter(|seed| run(setup, *seed).unwrap().pass).count()
    };
    assert_eq!((passes(&setup), passes(&tuned)), (0, 30));
}

#[test]
fn a_robot_file_keeps_all_else() {
    let text = "# mine\n[parameters]\nkv = 0.02 # as measured\n";
    let values = [(ParamId::from_name("front_kp").unwrap(), 7.5)];
    let tuned = rewrite(text, &values, "on 2026-01-01.").unwrap();
    assert!(tuned.contains("kv = 0.02 # as measured") && tuned.contains("front_kp = 7.5"));
    assert!(is_tuned(&tuned) && !is_tuned(text));
}

#[test]
fn what_can_be_tuned_are_the_numbers_of_the_mode_that_the_scenario_leaves_open() {
    let library = Library::new();
    for name in library.list(Kind::Scenario) {
        let own = library.scenario(&name).unwrap();
        if own.limits.is_empty() || !own.fleet.is_empty() {
            continue;
        }
        let setup = library.setup(&name, &Overrides::default()).unwrap();
        let groups = tunable(&setup, &own).unwrap();
        // The first group is what a page offers to search: what shapes the motion.
        let mut first = groups[0].parameters.iter();
        let gives_up = |(id, _): &(ParamId, f64)| *id == ParamId::MissionGiveUp;
        assert!(!first.any(gives_up), "{name}: {:?}", groups[0]);
        let all = groups.iter().flat_map(|group| &group.parameters);
        let all: Vec<Over> = all.map(|(id, _)| Over::Name(*id)).collect();
        tuned(&setup, &all).unwrap();
        assert!(all.iter().all(|over| over.check(&own).is_ok()), "{name}");
    }
    let setup = setup("mode1", &[("front_kp", 0.7)]);
    let own = library.scenario("mode1").unwrap();
    let groups = tunable(&setup, &own).unwrap();
    let front_kp = ParamId::from_name("front_kp").unwrap();
    assert!(
        groups[0].parameters.contains(&(front_kp, 0.7)),
        "{groups:?}"
    );
}

#[test]
fn a_search_ends_when_it_is_told_to_and_without_limits_needs_an_aim() {
    let own = Library::new().scenario("mode1").unwrap();
    let plan = |setup: Setup, aims: Objective| {
        let request = TuningRequest {
            over: over(&["front_kp"]),
            objective: aims,
            seed: 1,
            runs: None,
            held_out: Search::held_out(1, 2),
        };
        TuningPlan::new(setup, &own, request)
    };
    let whole = plan(setup("mode1", &[]), Objective::default()).unwrap();
    let asked = AtomicUsize::new(0);
    let ended = whole.run(&|_| (), &|| asked.fetch_add(1, Ordering::Relaxed) < 100);
    assert_eq!(ended.unwrap_err(), FileError::from(TuneError::Ended));
    assert!(asked.load(Ordering::Relaxed) < 200, "{asked:?}");
    let mut open = setup("mode1", &[]);
    open.scenario.limits.clear();
    let refused = plan(open.clone(), Objective::default()).unwrap_err();
    assert!(refused.to_string().contains("give an aim"), "{refused}");
    assert!(plan(open, "settling_s".parse().unwrap()).is_ok());
}
