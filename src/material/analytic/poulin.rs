//! Poulin and Fournier's brushed surface of parallel cylinders, as one integral.

use std::sync::Arc;

use glam::{DVec2, DVec3};

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

/// Points on a cylinder that the integral takes.
const STEPS: u32 = 200;

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
}

impl Across {
    fn new(w: DVec3) -> Self {
        let length = w.y.hypot(w.z);
        Self {
            side: if w.y < 0.0 { -1.0 } else { 1.0 },
            sine: w.y.abs() / length,
            cosine: w.z / length,
        }
    }
}

impl Cylinders {
    /// Half the width of a gap at the floor's height, from the axis of a cylinder: √(1−h²).
    fn foot(&self) -> f64 {
        (1.0 - self.h * self.h).max(0.0).sqrt()
    }

    /// Whether `across` sees the point of a cylinder with the normal (0, `normal.x`, `normal.y`): it faces the direction, and
    /// the next cylinder does not hide it, whose axis passes the ray at the distance d·cos a − sin(ψ−a).
    fn sees(&self, across: &Across, normal: DVec2) -> bool {
        let towards = normal.x * across.side;
        if towards * across.sine + normal.y * across.cosine <= 0.0 {
            return false;
        }
        let offset = towards * across.cosine - normal.y * across.sine;
        !(across.sine > self.h && offset > self.d * across.cosine - 1.0)
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

    /// ∫ f0(n)(n·u)(n·v) dψ over the points of a cylinder that both directions see, by midpoints.
    fn integrate_cap(&self, pair: &UpperPair, o: &Across, i: &Across) -> f64 {
        let end = if self.d < 2.0 * self.foot() {
            (0.5 * self.d).asin()
        } else {
            self.h.min(1.0).acos()
        };
        let step = 2.0 * end / f64::from(STEPS);
        let mut sum = 0.0;
        for k in 0..STEPS {
            let (sine, cosine) = (step * (f64::from(k) + 0.5) - end).sin_cos();
            let normal = DVec2::new(sine, cosine);
            if self.sees(o, normal) && self.sees(i, normal) {
                let normal = DVec3::new(0.0, sine, cosine);
                sum += self.reflect(pair, normal);
            }
        }
        sum * step
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
