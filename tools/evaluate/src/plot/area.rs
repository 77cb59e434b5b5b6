//! Rectangles of a picture.

/// A rectangle of the picture, pixels, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// Whether a point lies in it, half a pixel beyond its edges included.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        let across = (self.x - 0.5..=self.right() + 0.5).contains(&x);
        across && (self.y - 0.5..=self.bottom() + 0.5).contains(&y)
    }
}

/// Whether two rectangles have a point in common.
pub(super) fn overlap(a: &Area, b: &Area) -> bool {
    a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom()
}
