use super::*;
use rumbo_plant::rig::Mount;
use rumbo_plant::world::{Block, Wall, World};
use sight::Eyes;

fn set(sensor: &mut Vl53l0x, cycle: u64, register: u8, value: u8) {
    sensor.begin();
    sensor.write(register, cycle);
    sensor.write(value, cycle);
}

fn get(sensor: &mut Vl53l0x, cycle: u64, register: u8) -> u8 {
    sensor.begin();
    sensor.write(register, cycle);
    sensor.begin();
    sensor.read(cycle)
}

fn word(sensor: &mut Vl53l0x, cycle: u64, register: u8) -> u16 {
    sensor.begin();
    sensor.write(register, cycle);
    sensor.begin();
    u16::from_be_bytes([sensor.read(cycle), sensor.read(cycle)])
}

/// A millisecond after the other, as the plant goes on; the cycle in which it is ready.
fn wait(sensor: &mut Vl53l0x, from: u64, sight: Sight, noise: &Noise) -> u64 {
    let step = 1_000 * US;
    let mut cycle = from - from % step;
    for _ in 0..2_000 {
        if sensor.ends_within(cycle, cycle + step) {
            sensor.see(sight, noise);
        }
        cycle += step;
        if get(sensor, cycle, INTERRUPT_STATUS) & 7 != 0 {
            return cycle;
        }
    }
    panic!("it is never ready");
}

fn ready() -> Vl53l0x {
    let mut sensor = Vl53l0x::new(0);
    set(&mut sensor, 0, INTERRUPT_CONFIG, NEW_SAMPLE);
    set(&mut sensor, 0, SEQUENCE, 0xE8);
    // As libraries set the step before the last one.
    set(&mut sensor, 0, timing::PRE_PERIOD + 2, 0x96);
    sensor
}

fn wall(range_m: f64) -> Sight {
    let rate = 0.25 * 1.44 / (range_m * range_m);
    Sight { range_m, rate }
}

/// A range by a single measurement, and how long that took \[us\].
fn single(sensor: &mut Vl53l0x, at: u64, sight: Sight, noise: &Noise) -> (u16, u64) {
    set(sensor, at, START, 1);
    assert_eq!(get(sensor, at, START) & 1, 0);
    let end = wait(sensor, at, sight, noise);
    let range = word(sensor, end, RESULT + 10);
    set(sensor, end, INTERRUPT_CLEAR, 1);
    assert_eq!(get(sensor, end, INTERRUPT_STATUS), 0);
    (range, (end - at) / US)
}

#[test]
fn it_says_who_it_is_and_gives_words_of_its_memory_by_a_strobe() {
    let mut sensor = Vl53l0x::new(0);
    for (register, value) in [(0xC0, 0xEE), (0xC1, 0xAA), (0xC2, 0x10)] {
        assert_eq!(get(&mut sensor, 0, register), value);
    }
    set(&mut sensor, 0, PAGE, 7);
    for (asked, register, value) in [(0x6B, 0x92, 5), (0x77, 0x90, b'V' << 1 | b'L' >> 6)] {
        set(&mut sensor, 0, WORD_ASKED, asked);
        set(&mut sensor, 0, STROBE, 0);
        assert_ne!(get(&mut sensor, 0, STROBE), 0);
        assert_eq!(get(&mut sensor, 0, register), value);
    }
    set(&mut sensor, 0, PAGE, 1);
    assert_eq!(get(&mut sensor, 0, 0xC0), 0);
}

#[test]
fn its_noise_is_a_share_of_the_range_and_less_in_a_longer_measurement() {
    let noise = Noise::new(7, 0);
    let mut sensor = ready();
    let spread = |sensor: &mut Vl53l0x, begin: u64| {
        let (mut at, mut sum, mut squares, mut took) = (begin, 0.0, 0.0, 0);
        for _ in 0..400 {
            let (range, us) = single(sensor, at, wall(0.5), &noise);
            let range = f64::from(range);
            (sum, squares) = (sum + range / 400.0, squares + range * range / 400.0);
            (at, took) = (at + us * US, us);
        }
        (sum, libm::sqrt(squares - sum * sum), took)
    };
    let (mean, deviation, took_us) = spread(&mut sensor, 0);
    assert!((mean - 500.0).abs() < 20.0, "{mean}");
    assert!((deviation - 20.0).abs() < 2.5, "{deviation}");
    assert!((30_000..=35_000).contains(&took_us), "{took_us}");
    // The last step eight times as long.
    set(&mut sensor, 0, timing::FINAL_PERIOD + 1, 4);
    let (_, deviation, took_us) = spread(&mut sensor, 1 << 40);
    let share = libm::sqrt(33_000.0 / took_us as f64);
    assert!(took_us > 140_000, "{took_us}");
    assert!(
        (deviation / (20.0 * share) - 1.0).abs() < 0.15,
        "{deviation}"
    );
}

#[test]
fn beyond_its_reach_it_says_8190_and_further_out_with_a_lower_limit() {
    let noise = Noise::new(1, 0);
    let mut sensor = ready();
    assert!(single(&mut sensor, 0, wall(1.15), &noise).0 < 1_500);
    assert!(sensor.shown_m() > 0.9);
    let status = get(&mut sensor, 1 << 30, RESULT);
    assert_eq!(status & 0x78, COMPLETE);
    assert_eq!(single(&mut sensor, 1 << 31, wall(1.3), &noise).0, NOTHING);
    assert!(sensor.shown_m().is_infinite());
    assert_eq!(
        single(&mut sensor, 1 << 32, Sight::default(), &noise).0,
        NOTHING
    );
    // 0.1 million counts.
    set(&mut sensor, 1 << 33, RATE_LIMIT + 1, 13);
    assert!(single(&mut sensor, 1 << 33, wall(1.8), &noise).0 < 2_200);
    assert_eq!(single(&mut sensor, 1 << 34, wall(0.01), &noise).0, 30);
}

#[test]
fn it_measures_on_and_on_or_at_a_period_until_it_is_stopped() {
    let noise = Noise::new(1, 0);
    let mut sensor = ready();
    let ready_within = |sensor: &mut Vl53l0x, begin: u64, ms: u64| {
        let step = 1_000 * US;
        let times = (0..ms).filter(|ms| {
            let cycle = begin + ms * step;
            if sensor.ends_within(cycle, cycle + step) {
                sensor.see(wall(0.4), &noise);
            }
            let is_ready = get(sensor, cycle, INTERRUPT_STATUS) & 7 == NEW_SAMPLE;
            set(sensor, cycle, INTERRUPT_CLEAR, 1);
            is_ready
        });
        times.count()
    };
    set(&mut sensor, 0, START, 2);
    let count = ready_within(&mut sensor, 0, 1_000);
    assert!((29..=33).contains(&count), "{count}");
    let second = 1_000_000 * US;
    set(&mut sensor, second, START, 1);
    for (register, value) in [(PAGE, 1), (STOP, 0), (PAGE, 0), (INTERRUPT_CLEAR, 1)] {
        set(&mut sensor, second, register, value);
    }
    assert_eq!(ready_within(&mut sensor, second, 500), 0);
    // 100 ms.
    for (at, byte) in (100_u32 * 640).to_be_bytes().into_iter().enumerate() {
        set(&mut sensor, 2 * second, PERIOD + at as u8, byte);
    }
    set(&mut sensor, 2 * second, START, 4);
    assert_eq!(ready_within(&mut sensor, 2 * second, 1_000), 10);
}

#[test]
fn xshut_takes_it_off_the_bus_and_its_address_back() {
    let mut sensor = Vl53l0x::new(0);
    assert_eq!(sensor.address(0), Some(0x29));
    set(&mut sensor, 0, OWN_ADDRESS, 0x30);
    assert_eq!(sensor.address(1), Some(0x30));
    sensor.shut(2, true);
    assert_eq!(sensor.address(3), Some(0x30));
    sensor.shut(4, false);
    assert_eq!(sensor.address(1 << 30), None);
    sensor.shut(1 << 30, true);
    assert_eq!(sensor.address((1 << 30) + BOOT - 1), None);
    assert_eq!(sensor.address((1 << 30) + BOOT), Some(0x29));
}

#[test]
fn a_thing_before_a_wall_counts_by_the_share_of_the_field_that_it_fills() {
    let wall = Wall {
        from_m: [1.0, -3.0],
        to_m: [1.0, 3.0],
        thickness_m: 0.0,
    };
    let block = |y_m: f64| Block {
        center_m: [0.55, y_m],
        size_m: [0.1, 0.2],
        heading_rad: 0.0,
    };
    let seen = |blocks: &[Block]| {
        let world = World::new(&[wall], blocks).unwrap();
        Sight::of(&world, &Eyes::default(), &Mount::default(), 0)
    };
    let alone = seen(&[]);
    assert!(
        (alone.range_m - 1.0).abs() < 0.02 && alone.rate > 0.25,
        "{alone:?}"
    );
    let before = seen(&[block(0.0)]);
    assert!((before.range_m - 0.5).abs() < 0.02, "{before:?}");
    let beside = seen(&[block(0.15)]);
    assert!((0.55..0.9).contains(&beside.range_m), "{beside:?}");
    assert_eq!(seen(&[block(0.4)]), alone);
}
