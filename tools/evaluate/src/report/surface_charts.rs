//! Lobes of materials as shaded solids over the hemisphere.

use super::charts::{angles_text, reading};
use super::curve_charts::is_peaked;
use crate::measure::lobe_mesh::{LobeMesh, MeshSize, lobe_mesh};
use crate::measure::views::{self, PlottedChannel, PlottedValue};
use crate::plot::{
    Axis, Caption, Scale, SurfaceLobe, SurfacePanel, Surfaces, Viewpoint, style_number,
};
use merlkit::material::Loaded;
use merlkit::{Error, Result};

/// What of a value is drawn as a solid, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceOptions {
    /// The number drawn.
    pub value: PlottedValue,
    /// The scale of the radius; `None` is the chart's own choice.
    pub scale: Option<Scale>,
    /// Whether materials share a hemisphere, drawn translucent, instead of having one each.
    pub together: bool,
    /// From where they are seen.
    pub viewpoint: Viewpoint,
}

/// More hemispheres would be too small, and more lobes in one would hide each other.
const MOST_PANELS: usize = 6;
const MOST_TOGETHER: usize = 3;
/// Faces of a picture: half of them face the viewer, and each takes some 75 bytes of an SVG.
const FACES: usize = 16_000;
/// Spokes for each ring.
const SLENDERNESS: f64 = 1.4;
/// Decades of a logarithmic radius.
const DECADES: f64 = 4.0;

/// Refuses pictures of nothing, or of too much: by how many materials and angles they have.
///
/// # Errors
/// [`Error::Argument`] with the greatest number.
pub fn check_surfaces(materials: usize, thetas: usize, together: bool) -> Result<()> {
    let panels = if together { thetas } else { materials * thetas };
    let (what, fix) = if materials * thetas == 0 {
        let what = "no materials or no angles in one chart".to_owned();
        (what, "choose at least one of each".to_owned())
    } else if together && materials > MOST_TOGETHER {
        let what = format!("{materials} materials in one hemisphere");
        (
            what,
            format!("choose at most {MOST_TOGETHER}, or omit --together"),
        )
    } else if panels > MOST_PANELS {
        let what = format!("{panels} hemispheres in one chart");
        (
            what,
            format!("choose at most {MOST_PANELS} pairs of a material and an angle"),
        )
    } else {
        return Ok(());
    };
    Err(Error::argument(what, fix))
}

/// The lobes of `materials` for `wo` at each of `thetas` degrees, 0 to below 90.
///
/// # Errors
/// Those of [`check_surfaces`].
pub fn surface_chart(
    materials: &[Loaded],
    thetas: &[f64],
    options: SurfaceOptions,
) -> Result<Surfaces> {
    check_surfaces(materials.len(), thetas.len(), options.together)?;
    let scale = options
        .scale
        .unwrap_or_else(|| own_scale(materials, thetas, options.value));
    let rings = (FACES as f64 / SLENDERNESS / (materials.len() * thetas.len()) as f64).sqrt();
    let size = MeshSize {
        rings: rings as usize,
        spokes: (rings * SLENDERNESS) as usize,
    };
    // Of each material its lobes, by the angle.
    let mut rows = Vec::new();
    for (m, material) in materials.iter().enumerate() {
        let mut lobes = Vec::new();
        for &theta_o in thetas {
            let mesh = lobe_mesh(
                &**material.brdf(),
                theta_o,
                options.value,
                size,
                &|value, greatest| radius_fraction(scale, value, greatest),
            );
            lobes.push(solid(material.name(), style_number(m, 0, m), mesh));
        }
        rows.push(lobes);
    }
    let range = radius_range(scale, rows.iter().flatten());
    let panels = match options.together && materials.len() > 1 {
        true => share_panels(rows, thetas),
        false => separate_panels(rows, thetas),
    };
    let axis = Axis::new(radius_title(options.value, scale), scale);
    Ok(Surfaces {
        caption: caption(materials, thetas, options.value, scale),
        radius: axis.with_range(range.0, range.1),
        panels,
        viewpoint: options.viewpoint,
    })
}

/// Logarithmic where a lobe is narrow, or else even.
fn own_scale(materials: &[Loaded], thetas: &[f64], value: PlottedValue) -> Scale {
    let mut curves = Vec::new();
    for material in materials {
        for &theta_o in thetas {
            curves.push(views::lobe(&**material.brdf(), theta_o, value));
        }
    }
    if is_peaked(curves.iter()) {
        Scale::Log
    } else {
        Scale::Linear
    }
}

/// About where a value lies between the middle and the hemisphere.
fn radius_fraction(scale: Scale, value: f64, greatest: f64) -> f64 {
    let fraction = value / greatest;
    // Values that are no numbers, and those of a black lobe, are in the middle.
    if fraction.is_nan() || fraction <= 0.0 {
        return 0.0;
    }
    match scale {
        Scale::Linear => fraction.min(1.0),
        Scale::Root => fraction.min(1.0).sqrt(),
        Scale::Log => (1.0 + fraction.log10() / DECADES).clamp(0.0, 1.0),
    }
}

fn solid(name: &str, style: usize, mesh: LobeMesh) -> SurfaceLobe {
    let vertices = mesh
        .vertices
        .iter()
        .map(|v| (v.wi.to_array().map(f64::from), v.value));
    SurfaceLobe {
        label: name.to_owned(),
        vertices: vertices.collect(),
        spokes: mesh.spokes,
        style,
    }
}

/// The values in the middle and on the hemisphere.
fn radius_range<'a>(scale: Scale, lobes: impl Iterator<Item = &'a SurfaceLobe>) -> (f64, f64) {
    let (mut least, mut greatest) = (f64::INFINITY, 0f64);
    for lobe in lobes {
        for (_, value) in lobe
            .vertices
            .iter()
            .filter(|v| v.1 > 0.0 && v.1.is_finite())
        {
            (least, greatest) = (least.min(*value), greatest.max(*value));
        }
    }
    match scale {
        // A lobe whose values are all alike fills the hemisphere.
        Scale::Log => {
            let low = least.max(greatest * 10f64.powf(-DECADES));
            (low.min(0.1 * greatest), greatest)
        }
        _ => (0.0, greatest),
    }
}

/// One hemisphere at each angle for all materials.
fn share_panels(rows: Vec<Vec<SurfaceLobe>>, thetas: &[f64]) -> Vec<SurfacePanel> {
    let mut panels = Vec::new();
    for &theta_o in thetas {
        panels.push(SurfacePanel {
            title: format!("θ = {theta_o}°"),
            lobes: Vec::new(),
            theta_o,
        });
    }
    for lobes in rows {
        for (panel, lobe) in panels.iter_mut().zip(lobes) {
            panel.lobes.push(lobe);
        }
    }
    panels
}

/// A hemisphere for each lobe, the angles of a material one after the other.
fn separate_panels(rows: Vec<Vec<SurfaceLobe>>, thetas: &[f64]) -> Vec<SurfacePanel> {
    let mut panels = Vec::new();
    for lobes in rows {
        for (lobe, &theta_o) in lobes.into_iter().zip(thetas) {
            panels.push(SurfacePanel {
                title: format!("{}, θ = {theta_o}°", lobe.label),
                lobes: vec![lobe],
                theta_o,
            });
        }
    }
    panels
}

fn radius_title(value: PlottedValue, scale: Scale) -> String {
    let channel = match value.channel {
        PlottedChannel::Mean => String::new(),
        channel => format!(", {}", channel.name()),
    };
    let scale = match scale {
        Scale::Linear => "",
        Scale::Log => ", log scale",
        Scale::Root => ", root scale",
    };
    format!("{}{channel} [sr⁻¹]{scale}", value.symbol())
}

fn caption(materials: &[Loaded], thetas: &[f64], value: PlottedValue, scale: Scale) -> Caption {
    let names: Vec<&str> = materials.iter().map(Loaded::name).collect();
    let mut readings: Vec<String> = materials.iter().map(reading).collect();
    readings.dedup();
    let below = match scale {
        Scale::Log => " Values below the scale's low end are in the middle.",
        _ => "",
    };
    Caption::new(
        format!("{}: lobe at θ = {}", names.join(", "), angles_text(thetas)),
        format!(
            "Solids whose radius in the direction wi is {}, {}, in sr⁻¹ for wo at the polar angle θ.{below} The base has rings of \
             polar angle and lines of azimuth every 30°. Values: {}.",
            value.symbol(),
            value.channel.words(),
            readings.join("; ")
        ),
    )
}
