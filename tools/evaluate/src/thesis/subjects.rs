//! The materials and samplers of the thesis's experiments.

use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::SamplerSpec;
use merlkit::{Error, Result};

use super::published::PublishedTable;

/// The sixteen analytic BRDFs with the parameters of the thesis's experiments (its table 6.18), by our sound formulas. The names
/// are those of its tables.
const MODELS: [(&str, &str); 16] = [
    ("ashikhmin", "ashikhmin:ex=25,ey=25,Rs=0.39,Rd=0.6"),
    (
        "beardmaxwell",
        "beardmaxwell:omega=1,tau=0,nreal=0.37,nimag=2.82,Rs=0.4,Rd=0.75,Rv=0.5",
    ),
    ("blinn", "blinn:n=100,ks=1,kd=0.67"),
    ("coupled", "coupled:Rm=1,Ro=0.05"),
    ("he", "he:sigma=0.5,tau=3,lambda=800"),
    ("lafortune", "lafortune:n=100,kp=0.96,Cx=-1,Cy=-1,Cz=1"),
    ("lewis", "lewis:n=100,ks=1,kd=0"),
    ("minnaert", "minnaert:k=0.8,kd=1"),
    ("oren", "oren:s=0,r=1"),
    ("phong", "phong:n=100,ks=0.4,kd=0.6"),
    ("poulin", "poulin:d=2,h=0.01,n=100,ks=0.8,kd=0.2"),
    (
        "schlick-double",
        "schlick:SC=0.7,Sr=0.31,Sp=1,Ly=T,DC=1,Dr=0,Dp=1",
    ),
    ("schlick-single", "schlick:SC=0.7,Sr=0.31,Sp=1,Ly=F"),
    ("strauss", "strauss:s=0.76,m=0.91,ks=0.64,kd=0.5"),
    (
        "torrance",
        "torrance:rough=0.35,nreal=0.617,nimag=2.63,ks=0.7,kd=0.3",
    ),
    ("ward", "ward:sx=0.2,sy=0.2,ks=0.5,kd=0.5"),
];

/// A material of an experiment.
#[derive(Clone, Debug)]
pub(super) struct Subject {
    /// The thesis's name for it.
    pub name: &'static str,
    /// Ours.
    pub text: String,
}

impl Subject {
    /// The material, loaded by the rule of the smallest error.
    pub fn load(&self) -> Result<Loaded> {
        Ok(Material::resolve(&self.text)?
            .load(LookupRule::Floor)?
            .named(self.name))
    }

    /// The same model in another colour, given as `r/g/b`; a measured material stays as it is.
    pub fn coloured(&self, rgb: &str) -> Self {
        let text = match self.text.contains(':') {
            true => format!("{},rgb={rgb}", self.text),
            false => self.text.clone(),
        };
        Self { text, ..*self }
    }
}

/// The sixteen analytic BRDFs.
pub(super) fn models() -> Vec<Subject> {
    let mut subjects = Vec::with_capacity(MODELS.len());
    for (name, text) in MODELS {
        let text = text.to_owned();
        subjects.push(Subject { name, text });
    }
    subjects
}

/// One of the sixteen.
///
/// # Errors
/// [`Error::Argument`] for a name that is none of theirs.
pub(super) fn model(name: &str) -> Result<Subject> {
    let found = models().into_iter().find(|subject| subject.name == name);
    found.ok_or_else(|| Error::argument(format!("no model {name}"), "report this"))
}

/// The measured materials that name the rows of a table.
pub(super) fn measured(table: &str) -> Vec<Subject> {
    let names = PublishedTable::find(table).map_or_else(Vec::new, |t| t.names());
    let mut subjects = Vec::with_capacity(names.len());
    for name in names {
        let text = name.to_owned();
        subjects.push(Subject { name, text });
    }
    subjects
}

/// The factorisation of table 6.19, with the numbers of tables, cells and products that it has, and a fraction of cosine draws.
///
/// # Errors
/// [`Error::Argument`] for a name that the table has not.
pub(super) fn factorisation(name: &str, floor: f64) -> Result<SamplerSpec> {
    let axis = match printed_factor(name, "half")? {
        "true" => "half-vector",
        _ => "wi",
    };
    let text = format!(
        "factored:tables={},factors={}x{}/{}x{}/{axis}/{floor}",
        printed_factor(name, "uTh")?,
        printed_factor(name, "J")?,
        printed_factor(name, "K")?,
        printed_factor(name, "pTh")?,
        printed_factor(name, "pPh")?,
    );
    text.parse()
}

/// A cell of table 6.19.
fn printed_factor(name: &str, column: &str) -> Result<&'static str> {
    let cell = PublishedTable::find("6.19").and_then(|table| table.cell(name, column));
    cell.ok_or_else(|| Error::argument(format!("no factorisation of {name}"), "report this"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subject_resolves_and_has_a_factorisation() {
        let names = PublishedTable::find("6.19").unwrap().names();
        let models = models();
        let ours: Vec<&str> = models.iter().map(|m| m.name).collect();
        assert_eq!(ours, names);
        for subject in &models {
            Material::resolve(&subject.text).unwrap();
            factorisation(subject.name, 0.01).unwrap();
            Material::resolve(&subject.coloured("0.1/0.2/0.3").text).unwrap();
        }
        for table in ["5.10", "6.23", "6.24"] {
            for subject in measured(table) {
                Material::resolve(&subject.text).unwrap();
            }
        }
        assert!(model("nickel").is_err() && factorisation("nickel", 0.0).is_err());
    }
}
