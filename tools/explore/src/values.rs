//! Values of the BRDF: its lobe on a grid of directions, and its albedo.

use glam::{DQuat, Quat, Vec3};
use merlkit::color::Rgb;
use merlkit::geometry::spherical;
use merlkit::{Brdf, Wo};
use merlkit_evaluate::measure::directional_albedo_with_error;
use rayon::prelude::*;
use serde_json::json;

use crate::answer::{Answer, ArrayAnswer};
use crate::query::Query;
use crate::refusal::Refusal;
use crate::session::Session;

/// The most rows, and the most columns, of a lobe.
const MOST_LINES: usize = 4096;
/// The most directions of a lobe.
const MOST_DIRECTIONS: usize = 1_000_000;

/// f_r in sr⁻¹ on a grid of `wi`: θi = (r + ½)/R·90° and φi = c/C·360° in row r of R and column c of C.
pub(crate) fn lobe(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let wo = query.wo()?;
    let rows = query.count("rows", 1..=MOST_LINES)?;
    let columns = query.count("columns", 1..=MOST_LINES)?;
    if rows * columns > MOST_DIRECTIONS {
        return Err(Refusal::bad(format!(
            "a lobe of {rows} by {columns} directions; choose at most {MOST_DIRECTIONS}"
        )));
    }
    let (_, loaded) = session.load(query.material()?)?;
    let brdf = &**loaded.brdf();
    let values: Vec<f32> = (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| lobe_row(brdf, wo, (row as f64 + 0.5) / rows as f64, columns))
        .collect();
    let mirror = brdf.mirror(wo).map(|fraction| fraction.to_array());
    let mut answer = ArrayAnswer::new(json!({ "mirror": mirror }));
    answer.push_f32("f", &[rows, columns, 3], &values);
    Ok(answer.finish())
}

/// The values of one row, whose polar angle is a fraction of 90°.
fn lobe_row(brdf: &dyn Brdf, wo: Vec3, fraction: f64, columns: usize) -> Vec<f32> {
    let theta_i = (fraction * 90.0).to_radians();
    let mut wi = Vec::with_capacity(columns);
    for column in 0..columns {
        let phi_i = (column as f64 / columns as f64 * 360.0).to_radians();
        wi.push(spherical(theta_i, phi_i).as_vec3());
    }
    let mut values = vec![Rgb::ZERO; columns];
    brdf.eval_batch(Wo::One(wo), &wi, &mut values);
    values.iter().flat_map(|value| value.to_array()).collect()
}

/// A BRDF on a surface that is turned about its normal.
struct TurnedSurface<'a> {
    brdf: &'a dyn Brdf,
    turn: Quat,
}

impl Brdf for TurnedSurface<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.brdf.eval(self.turn * wo, self.turn * wi)
    }

    fn is_isotropic(&self) -> bool {
        self.brdf.is_isotropic()
    }
}

/// The directional albedo by quadrature, with the estimate of its error.
pub(crate) fn albedo(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (wo, theta, phi) = (query.wo()?, query.theta()?, query.phi()?);
    let (_, loaded) = session.load(query.material()?)?;
    let brdf = &**loaded.brdf();
    // The quadrature has wo in the x–z plane. An isotropic surface may stay as it is, to the bit.
    let estimate = if brdf.is_isotropic() {
        directional_albedo_with_error(brdf, theta.to_radians())
    } else {
        let turn = DQuat::from_rotation_z(phi.to_radians()).as_quat();
        let turned = TurnedSurface { brdf, turn };
        directional_albedo_with_error(&turned, theta.to_radians())
    };
    let mirror = brdf.mirror(wo).map(|fraction| fraction.to_array());
    Answer::json(&json!({
        "rgb": estimate.value.to_array(),
        "error": estimate.error,
        "mirror": mirror,
    }))
}
