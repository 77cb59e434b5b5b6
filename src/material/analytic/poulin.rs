//! Poulin and Fournier's brushed surface of parallel cylinders, as one integral.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DVec3;

use super::cylinder_cap::CylinderCap;
use super::model::{Formula, Model, Properties};
use super::pair::{UpperPair, clamped_power};
use super::parameters::{Parameters, declare};
use super::phong::Phong;
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "poulin",
    summary: "parallel cylinders along x, each with Phong's reflection",
    source: "Poulin and Fournier 1990",
    build,
};

/// Cylinders of radius 1 along x, their axes `d` apart, and a floor at height `h` above these.
struct Cylinders {
    d: f64,
    h: f64,
    local: Phong,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let d = declare("d", "distance of the cylinders' axes, in radii");
    let h = declare("h", "height of the floor above the axes, in radii");
    Ok(Arc::new(Cylinders {
        d: parameters.number(d, 0.0..=100.0, 7.5)?,
        h: parameters.number(h, 0.0..=1.0, 0.5)?,
        local: Phong {
            n: parameters.number(declare("n", "exponent of the lobe"), 0.0..=1e6, 10.0)?,
            ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, 0.4)?,
            kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.19)?,
            printed: false,
        },
    }))
}

/// A direction in the plane across the cylinders.
struct Across {
    /// 1 or −1: the side that the direction comes from.
    side: f64,
    /// Sine and cosine of its angle to the normal in that plane.
    sine: f64,
    cosine: f64,
    /// That angle, from 0 to π/2.
    angle: f64,
    /// The length of the direction's part in that plane.
    length: f64,
}

impl Across {
    fn new(w: DVec3) -> Self {
        let length = w.y.hypot(w.z);
        Self {
            side: if w.y < 0.0 { -1.0 } else { 1.0 },
            sine: w.y.abs() / length,
            cosine: w.z / length,
            angle: w.y.abs().atan2(w.z),
            length,
        }
    }
}

impl Cylinders {
    /// Half the width of a gap at the floor's height, from the axis of a cylinder: √(1−h²).
    fn foot(&self) -> f64 {
        (1.0 - self.h * self.h).max(0.0).sqrt()
    }

    /// The angles ψ of a cylinder's normals (0, sin ψ, cos ψ) that `across` sees, of those above the floor: they face the
    /// direction, and the next cylinder does not hide them, whose axis passes the ray at the distance d·cos a − sin(ψ − a).
    fn visible(&self, across: &Across, end: f64) -> [f64; 2] {
        let a = across.angle;
        let mut high = a + FRAC_PI_2;
        if across.sine > self.h {
            // The next cylinder hides what has sin(ψ − a) > d·cos a − 1.
            high = a + (self.d * across.cosine - 1.0).min(1.0).asin();
        }
        let low = (a - FRAC_PI_2).max(-end);
        let high = high.min(end);
        if across.side < 0.0 {
            [-high, -low]
        } else {
            [low, high]
        }
    }

    /// The width of the floor that a cylinder hides: 1/cos a − √(1−h²) − h·tan a, within the floor's `width`.
    fn hidden_floor(&self, across: &Across, width: f64) -> f64 {
        if across.sine <= self.h {
            return 0.0;
        }
        // (1 − h·sin a)/cos a is finite or infinite, never 0/0, because cos a > 0.
        let reach = (1.0 - self.h * across.sine) / across.cosine - self.foot();
        reach.clamp(0.0, width)
    }

    /// The width of the floor that both directions see.
    fn open_floor(&self, o: &Across, i: &Across) -> f64 {
        let width = (self.d - 2.0 * self.foot()).max(0.0);
        let hidden = [o, i].map(|across| self.hidden_floor(across, width));
        if o.side == i.side {
            width - hidden[0].max(hidden[1])
        } else {
            (width - hidden[0] - hidden[1]).max(0.0)
        }
    }

    /// The largest angle of a cylinder's normals above the floor, or above the line where it meets the next cylinder.
    fn end(&self) -> f64 {
        if self.d < 2.0 * self.foot() {
            (0.5 * self.d).asin()
        } else {
            self.h.min(1.0).acos()
        }
    }

    /// ∫ f0(n)(n·u)(n·v) dψ over the points of a cylinder that both directions see.
    fn integrate_cap(&self, pair: &UpperPair, o: &Across, i: &Across) -> f64 {
        let end = self.end();
        let (seen, lit) = (self.visible(o, end), self.visible(i, end));
        let (angle_o, angle_i) = (o.side * o.angle, i.side * i.angle);
        let cap = CylinderCap {
            product: o.length * i.length,
            middle: 0.5 * (angle_o + angle_i),
            cos_between: (angle_o - angle_i).cos(),
            along: pair.wo.x * pair.wi.x,
        };
        cap.integrate(&self.local, [seen[0].max(lit[0]), seen[1].min(lit[1])])
    }

    /// f0·(n·u)(n·v) about a normal.
    fn reflect(&self, pair: &UpperPair, normal: DVec3) -> f64 {
        let (o, i) = (normal.dot(pair.wo), normal.dot(pair.wi));
        let cos_alpha = 2.0 * o * i - pair.wo.dot(pair.wi);
        self.local.sound(clamped_power(cos_alpha, self.local.n)) * o * i
    }
}

impl Formula for Cylinders {
    /// 1/(d·cosθo·cosθi)·(∫ f0(n)(n·u)(n·v) dψ + floor·f0·cosθo·cosθi); cylinders without a distance are a plane.
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let flat = self.reflect(pair, DVec3::Z);
        let cosines = pair.cos_o * pair.cos_i;
        if self.d == 0.0 {
            return rgb * (flat / cosines);
        }
        let (o, i) = (Across::new(pair.wo), Across::new(pair.wi));
        let cap = self.integrate_cap(pair, &o, &i);
        let floor = self.open_floor(&o, &i) * flat;
        rgb * ((cap + floor) / (self.d * cosines))
    }

    /// No cylinder reflects more than it receives, once.
    fn properties(&self) -> Properties {
        let plane = self.d == 0.0 || self.h == 1.0;
        Properties {
            bounded: plane,
            symmetry: Properties::axes(plane),
            albedo_bound: Some(self.local.kd + self.local.ks),
            ..Properties::PLAIN
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::geometry::spherical;

    /// Points of a cylinder that the scan looks at, and of each of its visible parts that the sum takes.
    const SCANNED: u32 = 2000;
    const SUMMED: u32 = 20_000;
    /// The distance and the height of the floor of each surface.
    const SURFACES: [[f64; 2]; 5] = [[7.5, 0.5], [2.0, 0.01], [1.0, 0.0], [3.0, 0.9], [2.5, 0.0]];

    /// Whether a direction sees the point of a cylinder at ψ, by the conditions themselves.
    fn sees(cylinders: &Cylinders, w: DVec3, psi: f64) -> bool {
        let across = Across::new(w);
        let faces = w.y * psi.sin() + w.z * psi.cos() > 0.0;
        let offset = (across.side * psi - across.angle).sin();
        faces && !(across.sine > cylinders.h && offset > cylinders.d * across.cosine - 1.0)
    }

    fn both_see(cylinders: &Cylinders, pair: &UpperPair, psi: f64) -> bool {
        sees(cylinders, pair.wo, psi) && sees(cylinders, pair.wi, psi)
    }

    /// The angle between `seen`, which both directions see, and `hidden`, where they cease to.
    fn bisect(cylinders: &Cylinders, pair: &UpperPair, mut seen: f64, mut hidden: f64) -> f64 {
        for _ in 0..60 {
            let middle = 0.5 * (seen + hidden);
            if both_see(cylinders, pair, middle) {
                seen = middle;
            } else {
                hidden = middle;
            }
        }
        seen
    }

    /// The integral over a cylinder by midpoints of the parts that a scan finds visible.
    fn slow_integral(cylinders: &Cylinders, pair: &UpperPair) -> f64 {
        let end = cylinders.end();
        let step = 2.0 * end / f64::from(SCANNED);
        let (mut sum, mut start) = (0.0, None);
        for k in 0..=SCANNED {
            let psi = step * (f64::from(k) + 0.5) - end;
            let is_seen = k < SCANNED && both_see(cylinders, pair, psi);
            match start {
                None if is_seen => {
                    start = Some(bisect(cylinders, pair, psi, (psi - step).max(-end)))
                }
                Some(low) if !is_seen => {
                    let high = bisect(cylinders, pair, psi - step, psi.min(end));
                    sum += sum_midpoints(cylinders, pair, low, high);
                    start = None;
                }
                _ => {}
            }
        }
        sum
    }

    fn sum_midpoints(cylinders: &Cylinders, pair: &UpperPair, low: f64, high: f64) -> f64 {
        let step = (high - low) / f64::from(SUMMED);
        let mut sum = 0.0;
        for k in 0..SUMMED {
            let psi = low + step * (f64::from(k) + 0.5);
            sum += cylinders.reflect(pair, DVec3::new(0.0, psi.sin(), psi.cos()));
        }
        sum * step
    }

    fn cylinders(d: f64, h: f64, n: f64, kd: f64) -> Cylinders {
        let local = Phong {
            n,
            ks: 0.7,
            kd,
            printed: false,
        };
        Cylinders { d, h, local }
    }

    /// Directions all over the hemisphere, by fractions of an additive sequence, every third of them near the axis of the cylinders.
    fn direction(k: u32) -> DVec3 {
        let (number, k) = (k, f64::from(k));
        let (mut height, mut turn) = ((k * 0.618_034).fract(), (k * 0.754_878).fract());
        if number.is_multiple_of(3) {
            height *= 0.3;
            turn = 0.1 * (turn - 0.5).abs() + 0.5 * f64::from(number % 2);
        }
        spherical(height.acos(), turn * TAU)
    }

    /// The largest relative difference of both integrals over 24 pairs of directions.
    fn worst_error(cylinders: &Cylinders, seed: u32) -> f64 {
        let mut worst = 0f64;
        for k in seed..seed + 24 {
            let pair = UpperPair::new(direction(2 * k + 1), direction(2 * k + 2));
            let (o, i) = (Across::new(pair.wo), Across::new(pair.wi));
            let fast = cylinders.integrate_cap(&pair, &o, &i);
            let slow = slow_integral(cylinders, &pair);
            worst = worst.max((fast - slow).abs() / slow.max(1e-9));
        }
        worst
    }

    #[test]
    fn the_integral_agrees_with_midpoints_of_what_both_directions_see() {
        // The lobe of exponent 0 ends in a jump and that of 0.3 in a steep slope, where midpoints are off by more.
        for (n, allowed) in [
            (0.0, 1e-4),
            (0.3, 1e-5),
            (1.0, 2e-6),
            (10.0, 2e-6),
            (30.0, 2e-6),
            (137.5, 2e-6),
            (1e4, 2e-6),
        ] {
            for (number, [d, h]) in (0..).zip(SURFACES) {
                let worst = worst_error(&cylinders(d, h, n, 0.0), 100 * number + n as u32 % 89);
                assert!(worst < allowed, "d={d},h={h},n={n}: {worst:e}");
            }
        }
    }

    /// The diffuse part alone has a closed form.
    #[test]
    fn the_diffuse_part_is_exact() {
        for (number, [d, h]) in (0..).zip(SURFACES) {
            let mut diffuse = cylinders(d, h, 1.0, 0.6);
            diffuse.local.ks = 0.0;
            let worst = worst_error(&diffuse, 100 * number);
            assert!(worst < 1e-8, "d={d},h={h}: {worst:e}");
        }
    }
}
