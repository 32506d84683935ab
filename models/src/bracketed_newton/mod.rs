//! The root of a scalar function between two points of opposite sign: Newton steps, bisection where
//! they leave the bracket or shrink too slowly, down to rounding.

#[cfg(test)]
mod test;

/// Steps before giving up: bisection alone needs about 60 for a bracket of ordinary size.
const STEPS: u32 = 200;

/// The root of `function`, which returns (value, slope), in `bracket`: negative at its first end,
/// positive at its second (both open, neither is evaluated).
///
/// Ends when a step is below `resolution` or the spacing of the numbers, or when no number is left
/// between the ends. A kink or a flat part of the function costs bisections, never the answer.
pub fn bracketed_newton(bracket: [f64; 2], start: f64, resolution: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let [mut lower, mut upper] = bracket;
    let mut x = start;
    let (mut last_step, mut step_before) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..STEPS {
        let (value, slope) = function(x);
        if value == 0.0 {
            return x;
        }
        if value < 0.0 {
            lower = x;
        } else {
            upper = x;
        }
        let mut next = x - value / slope;
        // NaN (slope 0) fails this test as well
        let inside = next > lower.min(upper) && next < lower.max(upper);
        let shrinking = (next - x).abs() <= 0.5 * step_before.abs();
        let tiny = (next - x).abs() <= 2.0 * f64::EPSILON * x.abs() + resolution;
        if tiny {
            return if inside { next } else { x };
        }
        if !(inside && shrinking) {
            next = lower + 0.5 * (upper - lower);
            if next == lower || next == upper {
                return x;
            }
        }
        (step_before, last_step) = (last_step, next - x);
        x = next;
    }
    x
}
