//! The settings of half-vector tables as text: keys, domains, presets.

use super::HalfVector;
use super::settings::HalfVectorSettings;
use crate::geometry::half_vector_chart::PARTS;
use crate::sampler::azimuth_knots::azimuths_field;
use crate::sampler::settings::importance;
use crate::sampler::{Field, Preset, Settings};

impl Settings for HalfVectorSettings {
    type Method = HalfVector;

    fn fields() -> Vec<Field<Self>> {
        vec![
            Field::count(
                "tables",
                1..=1024,
                "tables over the polar angle of wo, dense towards the horizon",
                |s| s.tables,
                |s, value| s.tables = value,
            ),
            Field::count(
                "rows",
                2..=PARTS,
                "rows over θh, put where the material asks for them",
                |s| s.rows,
                |s, value| s.rows = value,
            ),
            Field::count(
                "segments",
                1..=256,
                "segments over the azimuth, each linear",
                |s| s.segments,
                |s, value| s.segments = value,
            ),
            Field::choice(
                "sides",
                &[("unfolded", false), ("folded", true)],
                "whether both sides of the plane of incidence are stored, or one for both",
                |s: &Self| s.fold,
                |s, value| s.fold = value,
            )
            .standing_alone(&["unfolded", "folded"]),
            azimuths_field(|s: &Self| s.azimuths, |s, value| s.azimuths = value),
            importance(|s: &Self| s.importance, |s, value| s.importance = value),
        ]
    }

    fn presets() -> Vec<Preset<Self>> {
        let mut presets = Vec::new();
        for (name, settings) in Self::PRESETS {
            let folded = if settings.fold { ", folded" } else { "" };
            let meaning = format!(
                "{} tables of {} rows by {} segments{folded}",
                settings.tables, settings.rows, settings.segments
            );
            presets.push(Preset::new(name, meaning, settings));
        }
        presets
    }
}
