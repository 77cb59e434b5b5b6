//! Directions that a sampler draws, with their densities and weights.

use glam::Vec3;
use merlkit::color::Rgb;
use merlkit::{Brdf, DirectionSample, Wo};
use serde_json::json;

use crate::affordable::parse_sampler;
use crate::answer::{Answer, ArrayAnswer};
use crate::query::Query;
use crate::refusal::Refusal;
use crate::session::Session;

/// The most draws of an answer.
const MOST_DRAWS: usize = 1_000_000;

/// Draws as columns; a failed draw is 0 in all of them.
struct DrawColumns {
    wi: Vec<f32>,
    pdf: Vec<f32>,
    weight: Vec<f32>,
    failed: usize,
}

/// `wi`, `pdf` and `weight` of draws that are spread together as well as the sampler can.
pub(crate) fn draws(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (id, wo) = (query.material()?, query.wo()?);
    let count = query.count("count", 1..=MOST_DRAWS)?;
    let seed = query.seed()?;
    let spec = parse_sampler(query.text("sampler"))?;
    let (_, loaded) = session.load(id)?;
    let sampler = session.build(id, &spec)?;
    let drawn = sampler.draw_stratified(wo, count, seed);
    let columns = tabulate_draws(&**loaded.brdf(), wo, &drawn);
    let mut answer = ArrayAnswer::new(json!({
        "sampler": spec.to_string(),
        "bytes": sampler.bytes(),
        "failed": columns.failed,
    }));
    answer.push_f32("wi", &[count, 3], &columns.wi);
    answer.push_f32("pdf", &[count], &columns.pdf);
    answer.push_f32("weight", &[count, 3], &columns.weight);
    Ok(answer.finish())
}

fn tabulate_draws(brdf: &dyn Brdf, wo: Vec3, drawn: &[Option<DirectionSample>]) -> DrawColumns {
    let mut wi = Vec::with_capacity(drawn.len());
    for draw in drawn {
        wi.push(draw.map_or(Vec3::ZERO, |draw| draw.wi));
    }
    // f·cosθi is 0 for the direction 0 of a failed draw.
    let mut values = vec![Rgb::ZERO; drawn.len()];
    brdf.eval_cos_batch(Wo::One(wo), &wi, &mut values);
    let mut columns = DrawColumns {
        wi: Vec::with_capacity(3 * drawn.len()),
        pdf: Vec::with_capacity(drawn.len()),
        weight: Vec::with_capacity(3 * drawn.len()),
        failed: 0,
    };
    for (k, draw) in drawn.iter().enumerate() {
        let pdf = draw.map_or(0.0, |draw| draw.pdf);
        // The weight of a draw, f·cosθi/pdf.
        let weight = match draw {
            Some(draw) => values[k] / draw.pdf,
            None => Rgb::ZERO,
        };
        columns.failed += usize::from(draw.is_none());
        columns.wi.extend(wi[k].to_array());
        columns.pdf.push(pdf);
        columns.weight.extend(weight.to_array());
    }
    columns
}
