//! The root of a scalar function between two points of opposite sign, down to rounding: with its slope by Newton steps, with
//! bisection where they leave the bracket or shrink too slowly; without by Chandrupatla's method.

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

/// Three times the iterations that bisection needs: from neighbouring powers of two down to neighbouring numbers, and
/// before that in ln m.
const MAX_ITERATIONS: u32 = 256;
/// Every so many steps of a bracketing bisect, whatever the interpolation says.
const FORCED_BISECTION: u32 = 4;

/// A point, its neighbour across the change of sign (itself if hit), and what is left of the function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// The better of the two ends of the last bracket.
    pub x: f64,
    /// The other one.
    pub other: f64,
    /// The residual at `x`.
    pub residual: f64,
}

impl Root {
    /// One that was hit, or is as near.
    pub fn exact(x: f64, residual: f64) -> Self {
        Self { x, other: x, residual }
    }
}

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection; in ln x as long
/// as the ends are positive and differ by more than a factor. `a` and `b`: places of unlike signs, or 0, with the values there. Ends at
/// `resolution`, a part of x.
#[inline]
pub fn bracketed(mut residual: impl FnMut(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64), resolution: f64) -> Root {
    if a.1 == 0.0 {
        return Root::exact(a.0, 0.0);
    }
    // a and b enclose the root, a is the latest point, c the one that a or b replaced
    let mut fraction = 0.5;
    for iteration in 1..=MAX_ITERATIONS {
        if b.1 == 0.0 {
            return Root::exact(b.0, 0.0);
        }
        let wide = a.0.min(b.0) > 0.0 && (a.0 > 4.0 * b.0 || b.0 > 4.0 * a.0);
        let x = if wide { a.0.sqrt() * b.0.sqrt() } else { a.0 + fraction * (b.0 - a.0) };
        if x == a.0 || x == b.0 {
            break;
        }
        let value = residual(x);
        if value == 0.0 {
            return Root::exact(x, 0.0);
        }
        let c;
        if (value > 0.0) == (a.1 > 0.0) {
            c = a;
        } else {
            c = b;
            b = a;
        }
        a = (x, value);
        let (better, width) = (if a.1.abs() < b.1.abs() { a } else { b }, (b.0 - a.0).abs());
        let least = (resolution * better.0.abs() + f64::MIN_POSITIVE) / width;
        // NaN between ends that are not finite, which states beyond all strains can ask for
        if least.is_nan() || least > 0.5 {
            break;
        }
        let xi = (a.0 - b.0) / (c.0 - b.0);
        let phi = (a.1 - b.1) / (c.1 - b.1);
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        fraction = if safe && iteration % FORCED_BISECTION != 0 {
            a.1 / (b.1 - a.1) * c.1 / (b.1 - c.1) + (c.0 - a.0) / (b.0 - a.0) * a.1 / (c.1 - a.1) * b.1 / (c.1 - b.1)
        } else {
            0.5
        }
        .clamp(least, 1.0 - least);
    }
    let (x, other) = if a.1.abs() < b.1.abs() { (a, b) } else { (b, a) };
    Root { x: x.0, other: other.0, residual: x.1 }
}
