//! The quadtree of the adaptive disc about an angle of `wo`.

use merlkit::sampler::AdaptiveDisc;
use serde_json::json;

use crate::affordable::parse_sampler;
use crate::answer::{Answer, ArrayAnswer};
use crate::query::{Query, shorten};
use crate::refusal::Refusal;
use crate::session::Session;

/// The squares of the tree whose angle is nearest to theta, with bounds and probabilities. The plane of incidence is y = 0 and `wo` lies
/// at x > 0.
pub(crate) fn disc(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (id, theta) = (query.material()?, query.theta()?);
    let n_max = query.number("n_max", 1.1..=1000.0)?;
    let spec = parse_sampler(&format!("adaptive-disc:n-max={n_max}"))?;
    let sampler = session.build(id, &spec)?;
    let Some(disc) = sampler.downcast::<AdaptiveDisc>() else {
        let message = format!("{} is no disc", shorten(&spec.to_string()));
        return Err(Refusal::new(500, message));
    };
    let tree = disc.subdivision(theta.to_radians());
    let count = tree.cells.len();
    let mut rectangles = Vec::with_capacity(4 * count);
    let (mut bounds, mut probabilities) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for cell in &tree.cells {
        let (low, high) = (cell.corner, cell.corner + cell.side);
        rectangles.extend([low.x as f32, low.y as f32, high.x as f32, high.y as f32]);
        bounds.push(cell.bound);
        probabilities.push(cell.share as f32);
    }
    let mut answer = ArrayAnswer::new(json!({
        "theta": tree.theta_o.to_degrees(),
        "n_max": n_max,
        "bytes": sampler.bytes(),
        "trials": tree.trials,
    }));
    answer.push_f32("rectangles", &[count, 4], &rectangles);
    answer.push_f32("bounds", &[count], &bounds);
    answer.push_f32("probabilities", &[count], &probabilities);
    Ok(answer.finish())
}
