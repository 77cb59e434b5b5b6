//! Fewer knots for the same curve (Douglas and Peucker 1973).

/// Positions of the knots, first and last among them, of a polyline through some of the points (i, `y[i]`) that stays within
/// `tolerance` of all of them, measured along y. `y` must be finite; fewer than three points are kept as they are.
///
/// The measure is vertical because a CDF's error is: between kept knots, the probability up to any point is off by at most
/// `tolerance`.
///
/// See [`Curves`](crate::distribution::Curves) for an example.
pub fn simplify(y: &[f64], tolerance: f64) -> Vec<usize> {
    if y.len() < 3 {
        return (0..y.len()).collect();
    }
    // Chords that have not been checked are open. One that strays too far from the points is replaced by two, through
    // the point that it strays from most. The list takes the place of recursion.
    let mut keep = vec![0, y.len() - 1];
    let mut open = vec![(0, y.len() - 1)];
    while let Some((first, last)) = open.pop() {
        if let Some((worst, distance)) = farthest(y, first, last)
            && distance > tolerance
        {
            keep.push(worst);
            open.push((first, worst));
            open.push((worst, last));
        }
    }
    keep.sort_unstable();
    keep
}

/// The point strictly between `first` and `last` farthest from their chord, and its distance.
fn farthest(y: &[f64], first: usize, last: usize) -> Option<(usize, f64)> {
    let slope = (y[last] - y[first]) / (last - first) as f64;
    let mut worst: Option<(usize, f64)> = None;
    for (i, &value) in y.iter().enumerate().take(last).skip(first + 1) {
        // |y(i) − chord(i)| with chord(i) = y(first) + slope·(i − first), along y.
        let distance = (value - (y[first] + slope * (i - first) as f64)).abs();
        if worst.is_none_or(|w| distance > w.1) {
            worst = Some((i, distance));
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest_distance(y: &[f64], knots: &[usize]) -> f64 {
        let mut worst = 0.0f64;
        for pair in knots.windows(2) {
            for i in pair[0]..=pair[1] {
                let t = (i - pair[0]) as f64 / (pair[1] - pair[0]) as f64;
                worst = worst.max((y[i] - (y[pair[0]] * (1.0 - t) + y[pair[1]] * t)).abs());
            }
        }
        worst
    }

    #[test]
    fn stays_within_the_tolerance_with_fewer_knots() {
        let y: Vec<f64> = (0..=1024)
            .map(|i| 1.0 - (-f64::from(i) / 40.0).exp())
            .collect();
        let mut before = y.len();
        for tolerance in [1e-5, 1e-4, 1e-3, 1e-2, 1e-1] {
            let knots = simplify(&y, tolerance);
            assert!(largest_distance(&y, &knots) <= tolerance);
            assert!(knots.len() < before, "{tolerance}: {}", knots.len());
            before = knots.len();
        }
    }

    #[test]
    fn lines_need_two_knots_and_zero_tolerance_keeps_every_bend() {
        let line: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.25).collect();
        assert_eq!(simplify(&line, 1e-12), [0, 99]);
        assert_eq!(simplify(&[0.0, 1.0, 0.5, 2.0], 0.0), [0, 1, 2, 3]);
        assert_eq!(simplify(&[0.0, 1.0, 0.5, 2.0], f64::INFINITY), [0, 3]);
        assert_eq!(simplify(&[3.0], 0.1), [0]);
        assert!(simplify(&[], 0.1).is_empty());
    }
}
