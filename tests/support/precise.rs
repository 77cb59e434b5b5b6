//! Sums with twice the digits of f64.

/// Neumaier's compensated sum.
#[derive(Clone, Copy, Default)]
pub struct Exact {
    sum: f64,
    rest: f64,
}

impl Exact {
    pub fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.rest += if self.sum.abs() >= x.abs() {
            (self.sum - sum) + x
        } else {
            (x - sum) + self.sum
        };
        self.sum = sum;
    }

    pub fn value(self) -> f64 {
        self.sum + self.rest
    }
}

/// Distance of an f32 from an exact value, in units of the last place of f32 there.
pub fn ulp(found: f32, exact: f64) -> f64 {
    let near = exact.abs() as f32;
    (f64::from(found) - exact).abs() / f64::from(near.next_up() - near)
}
