//! Colours for values: from dark to light, in steps that look even, and distinguishable for every eye.

/// Viridis at even shares (S. van der Walt and N. Smith, 2015; CC0).
const VIRIDIS: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];
/// Of what has no value.
pub(crate) const NONE: &str = "#8a8f94";

/// The colour at a share of the way, 0 to 1.
pub(crate) fn colour(share: f64) -> String {
    if !share.is_finite() {
        return NONE.to_owned();
    }
    let place = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let index = (place as usize).min(VIRIDIS.len() - 2);
    let part = place - index as f64;
    let [red, green, blue] = [0, 1, 2].map(|channel| {
        let [from, to] = [VIRIDIS[index][channel], VIRIDIS[index + 1][channel]];
        (from + part * (to - from)).round() as u8
    });
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The lowest and the highest of all finite values, never the same.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
    match high.partial_cmp(&low) {
        Some(std::cmp::Ordering::Greater) => [low, high],
        Some(std::cmp::Ordering::Equal) => [low, low + low.abs().max(1.0) * 1e-3],
        _ => [0.0, 1.0],
    }
}

/// Where a value lies in a range, 0 to 1.
pub(crate) fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    (value - low) / (high - low)
}
