//! A lobe in a file.

use super::settings::{LobeParameters, LobeSettings};
use crate::Result;
use crate::sampler::store::{TensorWriter, Tensors};

/// Adds the parameters to a file.
pub(super) fn write(parameters: &LobeParameters, out: &mut TensorWriter) {
    let LobeParameters {
        along,
        across,
        diffuse,
    } = *parameters;
    out.add("lobe.parameter", [along, across, diffuse]);
}

/// Reads the parameters that the record states too; their domains are checked where a lobe is put together.
pub(super) fn read(tensors: &Tensors, settings: &LobeSettings) -> Result<LobeParameters> {
    let stored = tensors.get::<f32>("lobe.parameter")?;
    let [along, across, diffuse] = stored[..] else {
        return Err(tensors.invalid_in("lobe.parameter", 0, "3 values", stored.len().to_string()));
    };
    let parameters = LobeParameters {
        along,
        across,
        diffuse,
    };
    if settings.parameters != Some(parameters) {
        let expected = format!("the parameters of the record, {:?},", settings.parameters);
        return Err(tensors.invalid_in("lobe.parameter", 0, &expected, format!("{stored:?}")));
    }
    Ok(parameters)
}
