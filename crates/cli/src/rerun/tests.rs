use super::*;

#[test]
fn telemetry_differs_by_named_signals() {
    let frame = |left_rad_s: f32| {
        let mut telemetry = Telemetry::default();
        telemetry.wheel_rad_s[1].left = left_rad_s;
        Burst {
            t_us: 1_240_000,
            to_robot: false,
            bytes: FromRobot::Telemetry(telemetry).frame(7).bytes().to_vec(),
        }
    };
    assert_eq!(
        frame(3.0).difference(&frame(3.5)),
        "telemetry at 1.240 s: left_rad_s was 3, is 3.5"
    );
}

fn link(bytes: &[u8]) -> Vec<Burst> {
    let burst = |(index, byte): (usize, &u8)| Burst {
        t_us: 10_000 * index as u64,
        to_robot: false,
        bytes: vec![*byte],
    };
    bytes.iter().enumerate().map(burst).collect()
}

#[test]
fn the_first_difference_is_found_wherever_it_is() {
    let at = |was: &[u8], is: &[u8], cut| match first_difference(&link(was), &link(is), cut) {
        Some(Verdict::Differs(t_s, _)) => Some(t_s),
        _ => None,
    };
    assert_eq!(at(b"abc", b"abc", false), None);
    assert_eq!(at(b"abc", b"abd", false), Some(0.02));
    assert_eq!(at(b"abc", b"ab", false), Some(0.02));
    assert_eq!(at(b"ab", b"abc", false), Some(0.02));
    assert_eq!(at(b"ab", b"abc", true), None);
    assert_eq!(at(b"abc", b"ab", true), Some(0.02));
}
