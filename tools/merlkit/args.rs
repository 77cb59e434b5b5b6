//! Options that several commands share.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use merlkit::Error;
use merlkit::brdf::LookupRule;
use merlkit::merl::Material;

/// Parses a lookup rule by its name.
pub fn lookup_rule() -> impl TypedValueParser<Value = LookupRule> {
    PossibleValuesParser::new(LookupRule::ALL.map(LookupRule::name))
        .map(|name| LookupRule::ALL.into_iter().find(|r| r.name() == name).unwrap_or_default())
}

/// Resolves all material arguments before any work begins.
pub fn resolve(arguments: &[String]) -> Result<Vec<Material>, Error> {
    arguments.iter().map(|a| Material::resolve(a)).collect()
}
