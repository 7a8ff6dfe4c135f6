//! Parts of an image that tell contenders apart: where their errors differ most, rather where there is something to see.

/// Side of a crop, over the shorter side of the image.
const SIDE: f64 = 0.24;
/// Steps between crops that are looked at, over their side.
const STEP: usize = 8;
/// No pixel counts for more: one that is this far off is as bad as the eye can tell.
const WORST: f64 = 1.0;
/// The second crop shows another contender at its worst where that differs by so much of what the first shows.
const OTHER: f64 = 0.5;

/// A plain part counts so much, over one whose quarters differ by their mean.
const PLAIN: f64 = 0.5;

/// A crop and what it shows.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    corner: [usize; 2],
    /// Between the errors of the worst contender and the best, times what there is to see.
    spread: f64,
    worst: usize,
}

/// Two crops, as column, row, width and height, from what there is to see, by its `luminance`, and the relative squared `errors`
/// of every pixel by each contender; one, where there is no room for two.
pub(super) fn choose([width, height]: [usize; 2], luminance: &[f64], errors: &[Vec<f64>]) -> Vec<[usize; 4]> {
    let side = ((SIDE * width.min(height) as f64).round() as usize).max(1);
    let clamped = |error: &f64| if error.is_nan() { WORST } else { error.min(WORST) };
    let sums: Vec<Sums> = errors.iter().map(|errors| Sums::of(width, errors.iter().map(clamped))).collect();
    let seen = Sums::of(width, luminance.iter().copied());
    let places = |length: usize| (0..=length - side).step_by((side / STEP).max(1));
    let corners = places(height).flat_map(|y| places(width).map(move |x| [x, y]));
    let mut all: Vec<Candidate> = corners.map(|corner| Candidate::at(corner, side, &sums, &seen)).collect();
    // The order of equal ones stays.
    all.sort_by(|a, b| b.spread.total_cmp(&a.spread));
    let second = [side + side / 4, side].into_iter().find_map(|gap| second(&all, gap));
    let crops = [all.first(), second].into_iter().flatten();
    crops.map(|crop| [crop.corner[0], crop.corner[1], side, side]).collect()
}

/// The best that is `gap` away from the first.
fn second(all: &[Candidate], gap: usize) -> Option<&Candidate> {
    let first = &all[0];
    let is_apart =
        |other: &&Candidate| first.corner.iter().zip(other.corner).any(|(a, b)| a.abs_diff(b) >= gap);
    let is_other = |other: &&Candidate| other.worst != first.worst && other.spread > OTHER * first.spread;
    let apart = || all.iter().filter(is_apart);
    apart().find(is_other).or_else(|| apart().next())
}

impl Candidate {
    fn at(corner: [usize; 2], side: usize, sums: &[Sums], seen: &Sums) -> Self {
        let errors: Vec<f64> = sums.iter().map(|sums| sums.mean(corner, side).sqrt()).collect();
        let worst = (0..errors.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap_or(0);
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = errors.get(worst).copied().unwrap_or(0.0);
        // A contender alone is looked at where it is worst.
        let spread = if errors.len() > 1 { most - least } else { most };
        Self { corner, spread: spread * (PLAIN + seen.contrast(corner, side).min(1.0)), worst }
    }
}

/// Sums over all pixels above and to the left.
struct Sums {
    stride: usize,
    values: Vec<f64>,
}

impl Sums {
    fn of(width: usize, of: impl ExactSizeIterator<Item = f64>) -> Self {
        let stride = width + 1;
        let mut values = vec![0.0; stride * (of.len() / width + 1)];
        for (pixel, value) in of.enumerate() {
            let at = (pixel / width + 1) * stride + pixel % width + 1;
            values[at] = value + values[at - 1] + values[at - stride] - values[at - stride - 1];
        }
        Self { stride, values }
    }

    fn mean(&self, [x, y]: [usize; 2], side: usize) -> f64 {
        let at = |x: usize, y: usize| self.values[y * self.stride + x];
        let sum = at(x + side, y + side) - at(x, y + side) - at(x + side, y) + at(x, y);
        (sum / (side * side) as f64).max(0.0)
    }

    /// Between the means of its brightest quarter and its darkest, over its own: noise hardly counts.
    fn contrast(&self, [x, y]: [usize; 2], side: usize) -> f64 {
        let half = side / 2;
        if half == 0 {
            return 0.0;
        }
        let means =
            [[x, y], [x + half, y], [x, y + half], [x + half, y + half]].map(|at| self.mean(at, half));
        let [least, most] =
            [means.iter().copied().fold(f64::INFINITY, f64::min), means.iter().copied().fold(0.0, f64::max)];
        if most > 0.0 { (most - least) / (0.5 * (most + least)) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of an image of 40 x 30 pixels, 1 in a square of 7 pixels at a corner.
    fn error_at([left, top]: [usize; 2]) -> Vec<f64> {
        let is_in = |pixel: usize| {
            let (x, y) = (pixel % 40, pixel / 40);
            (left..left + 7).contains(&x) && (top..top + 7).contains(&y)
        };
        (0..1200).map(|pixel| if is_in(pixel) { 1.0 } else { 0.0 }).collect()
    }

    #[test]
    fn crops_are_where_contenders_differ() {
        let plain = [1.0; 1200];
        let found = choose([40, 30], &plain, &[error_at([5, 6]), error_at([25, 20])]);
        assert_eq!(found, [[5, 6, 7, 7], [25, 20, 7, 7]]);
        // What is wrong with both tells nothing.
        let both: Vec<f64> = error_at([5, 6]).iter().zip(error_at([25, 20])).map(|(a, b)| a + b).collect();
        assert_eq!(choose([40, 30], &plain, &[error_at([5, 6]), both])[0], [25, 20, 7, 7]);
        assert_eq!(choose([40, 30], &plain, &[error_at([9, 9])])[0], [9, 9, 7, 7]);
        // Of two that tell as much, the one with an edge in it.
        let both: Vec<f64> = error_at([5, 6]).iter().zip(error_at([25, 20])).map(|(a, b)| a + b).collect();
        let edge: Vec<f64> = (0..1200).map(|pixel| if pixel % 40 < 28 { 1.0 } else { 3.0 }).collect();
        assert_eq!(choose([40, 30], &edge, &[both])[0], [25, 20, 7, 7]);
    }

    #[test]
    fn every_image_has_a_crop() {
        for (size, errors) in
            [([1, 1], vec![f64::NAN]), ([3, 1], vec![f64::INFINITY, 0.0, 1e300]), ([2, 2], vec![0.0; 4])]
        {
            let crops = choose(size, &errors, &[errors.clone(), errors.clone()]);
            assert!(
                !crops.is_empty()
                    && crops.iter().all(|[x, y, w, h]| x + w <= size[0] && y + h <= size[1] && *w > 0)
            );
        }
    }
}
