//! Division of a line.

use crate::mesh::MeshError;

/// Division of a line, from its start to its end. If the number of divisions follows from sizes, it is rounded and
/// all sizes are scaled to fill the line.
///
/// Sizes of all gradings but [`Grading::Capped`] form a geometric series: n sizes hᵢ = h₁ qⁱ⁻¹ over the length L with
///
/// ```text
/// h₁ = L (q − 1)/(qⁿ − 1)        hₙ/h₁ = qⁿ⁻¹        (q = 1: h₁ = L/n)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grading {
    /// Equal sizes.
    Uniform {
        /// Number of divisions.
        count: usize,
    },
    /// A number of sizes, the last one `ratio` times the first.
    Ratio {
        /// Number of divisions.
        count: usize,
        /// Last size over first size.
        ratio: f64,
    },
    /// A number of sizes that starts with a given one; q follows.
    First {
        /// Number of divisions.
        count: usize,
        /// First size.
        first: f64,
    },
    /// Sizes that grow by a factor until they reach the largest, and stay there.
    Capped {
        /// First size.
        first: f64,
        /// Each size over the one before it.
        growth: f64,
        /// Largest size.
        largest: f64,
    },
}

/// A line of so many elements is a mistake in a size.
pub const MOST_DIVISIONS: usize = 100_000;

/// The smallest size over the length: below it, elements are slivers that [`crate::mesh::Mesh::new`] refuses.
const SMALLEST_FRACTION: f64 = 1e-9;

impl Grading {
    /// Positions from 0 to `length`, strictly increasing, both ends exact.
    ///
    /// # Errors
    ///
    /// A length, number, size or factor that is not positive and finite, sizes larger than the line, more than
    /// [`MOST_DIVISIONS`].
    pub fn positions(self, length: f64) -> Result<Vec<f64>, MeshError> {
        if !(length > 0.0 && length.is_finite()) {
            return refuse(format!("the length to divide is {length}, it must be positive"));
        }
        self.check(length)?;
        let sizes = match self {
            Self::Uniform { count } => vec![1.0; count],
            Self::Ratio { count, ratio } => series(count, ratio),
            Self::First { count, first } => powers(count, growth_from_first(count, first / length)),
            Self::Capped { first, growth, largest } => capped(length, first, growth, largest)?,
        };
        cumulated(&sizes, length)
    }

    fn check(self, length: f64) -> Result<(), MeshError> {
        let positive = |name, value: f64| {
            let is_fine = value > 0.0 && value.is_finite();
            if is_fine { Ok(()) } else { refuse(format!("{name} is {value}, it must be positive")) }
        };
        let size = |name, value: f64| {
            positive(name, value)?;
            if value > length {
                return refuse(format!("{name} is {value}, more than the length {length} to divide"));
            }
            Ok(())
        };
        let number = |count: usize| match count {
            0 => refuse("a line must be divided at least once".to_owned()),
            count if count > MOST_DIVISIONS => Err(too_many(count as f64, length)),
            _ => Ok(()),
        };
        match self {
            Self::Uniform { count } => number(count),
            Self::Ratio { count, ratio } => number(count).and_then(|()| positive("the ratio of the sizes", ratio)),
            Self::First { count, first } => number(count).and_then(|()| size("the first size", first)),
            Self::Capped { first, growth, largest } => {
                positive("the first size", first)?;
                positive("the growth of the sizes", growth)?;
                positive("the largest size", largest)
            }
        }
    }
}

/// Divides a line piece by piece through `stops` (ascending, the first is the start): sizes grow from `first` by
/// `growth` up to `largest`, across the stops too.
///
/// # Errors
///
/// As [`Grading::positions`] of [`Grading::Capped`]; stops that do not ascend.
pub(crate) fn capped_through(stops: &[f64], first: f64, growth: f64, largest: f64) -> Result<Vec<f64>, MeshError> {
    let mut positions = vec![stops.first().copied().unwrap_or(0.0)];
    let mut size = first;
    for ends in stops.windows(2) {
        let piece = Grading::Capped { first: size, growth, largest }.positions(ends[1] - ends[0])?;
        size = (growth * (piece[piece.len() - 1] - piece[piece.len() - 2])).min(largest);
        positions.extend(piece[1..piece.len() - 1].iter().map(|position| ends[0] + position));
        positions.push(ends[1]);
    }
    Ok(positions)
}

fn refuse<T>(reason: String) -> Result<T, MeshError> {
    Err(MeshError(reason))
}

/// More divisions than are allowed.
pub(crate) fn too_many(count: f64, length: f64) -> MeshError {
    MeshError(format!(
        "a length of {length} would be divided {count:.0} times, more than {MOST_DIVISIONS}; are the sizes too small?"
    ))
}

/// A geometric series from 1 to `ratio`.
fn series(count: usize, ratio: f64) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|index| ratio.powf(index as f64 / last)).collect()
}

/// 1, q, q², …
fn powers(count: usize, growth: f64) -> Vec<f64> {
    (0..count).map(|index| growth.powf(index as f64)).collect()
}

/// q of `count` sizes that start with the fraction `first` of the line: (qⁿ − 1)/(q − 1) = 1/first, by bisection of
/// ln q, of which the sum is a monotone function.
fn growth_from_first(count: usize, first: f64) -> f64 {
    /// Halvings of an interval of ln q to the last bit.
    const BISECTIONS: usize = 200;
    if count == 1 {
        return 1.0;
    }
    let sum = |logarithm: f64| (0..count).map(|index| (logarithm * index as f64).exp()).sum::<f64>();
    // The sum is at least 1 + q, which bounds q from above; where q vanishes, the first size is all.
    let limit = first.recip().ln().max(1.0) + 40.0;
    let (mut low, mut high) = (-limit, limit);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if sum(middle) < first.recip() { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

fn capped(length: f64, first: f64, growth: f64, largest: f64) -> Result<Vec<f64>, MeshError> {
    let mut size = first.min(largest);
    let mut sizes = Vec::new();
    let mut filled = 0.0;
    // The last size is taken if at least half of it fits.
    while sizes.is_empty() || filled + 0.5 * size <= length {
        if sizes.len() == MOST_DIVISIONS {
            return Err(too_many(length / size, length));
        }
        sizes.push(size);
        filled += size;
        size = (size * growth).min(largest);
    }
    Ok(sizes)
}

/// Positions from sizes of any scale.
fn cumulated(sizes: &[f64], length: f64) -> Result<Vec<f64>, MeshError> {
    let scale = length / sizes.iter().sum::<f64>();
    let smallest = scale * sizes.iter().copied().fold(f64::INFINITY, f64::min);
    if smallest.is_nan() || smallest < SMALLEST_FRACTION * length {
        return refuse(format!("the sizes go down to {smallest:e}, nothing against the length {length}"));
    }
    let mut positions = vec![0.0];
    let mut position = 0.0;
    for size in &sizes[..sizes.len() - 1] {
        position += scale * size;
        positions.push(position);
    }
    positions.push(length);
    Ok(positions)
}
