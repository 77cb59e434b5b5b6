//! Formulas that divide by zero, overflow or have no bound, by their parameters.

/// A formula that is hard on values or samplers.
#[derive(Clone, Copy, Debug)]
pub struct HardModel {
    /// Its name, in kebab-case.
    pub name: &'static str,
    /// What is difficult about it, in a few words.
    pub about: &'static str,
    /// The formula, as a MATERIAL.
    pub text: &'static str,
}

const fn model(name: &'static str, about: &'static str, text: &'static str) -> HardModel {
    HardModel { name, about, text }
}

impl HardModel {
    /// All of them, by the model's name.
    pub const ALL: [Self; 20] = [
        model(
            "minnaert-rim",
            "no bound where either cosine is 0",
            "minnaert:k=0.5,kd=1",
        ),
        model(
            "ward-rim",
            "no bound at the rim, and a wide lobe",
            "ward:sx=0.3,sy=0.3,ks=0.5,kd=0.1",
        ),
        model(
            "ward-streak",
            "a lobe 100 times as long as it is wide",
            "ward:sx=0.01,sy=1,ks=0.5,kd=0.01",
        ),
        model(
            "torrance-rim",
            "divides by both cosines",
            "torrance:rough=0.35,ks=0.7,kd=0.3",
        ),
        model(
            "beardmaxwell-rim",
            "no bound at the rim, and no light beyond tau = 0",
            "beardmaxwell:tau=0",
        ),
        model(
            "schlick-mirror",
            "the slope's distribution is 0/0 at the normal",
            "schlick:Sr=0,Sp=1",
        ),
        model(
            "schlick-line",
            "the azimuth's distribution is 0/0 along an axis",
            "schlick:Sr=0.3,Sp=0",
        ),
        model(
            "strauss-mirror",
            "an infinite exponent",
            "strauss:s=1,m=0.9",
        ),
        model(
            "phong-needle",
            "a lobe of a twentieth of a degree",
            "phong:n=1000000,ks=0.5,kd=0.1",
        ),
        model(
            "lewis-needle",
            "half vectors within a twentieth of a degree",
            "lewis:n=1000000,ks=0.5,kd=0.1",
        ),
        model(
            "he-rough",
            "a sum of thousands of terms that underflow one by one",
            "he:sigma=5.77,tau=20,lambda=577",
        ),
        model("he-smooth", "nothing but a mirror", "he:sigma=0,ks=1,kd=0"),
        model(
            "he-rim",
            "divides by both cosines",
            "he:sigma=0.2,tau=3,lambda=800",
        ),
        model(
            "poulin-dense",
            "cylinders that are no distance apart",
            "poulin:d=0,h=0.5,n=10,ks=0.5,kd=0.2",
        ),
        model(
            "poulin-flat",
            "cylinders sunk in the floor",
            "poulin:d=2,h=1,n=10,ks=0.5,kd=0.2",
        ),
        model(
            "poulin-rim",
            "no bound at the rim across the cylinders",
            "poulin:d=2,h=0.01,n=100,ks=0.8,kd=0.2",
        ),
        model("oren-rim", "tangents at the horizon", "oren:s=1.57,r=1"),
        model(
            "lafortune-black",
            "every lobe below the horizon",
            "lafortune:n=20,kp=0,Cx=-1,Cy=-1,Cz=-1",
        ),
        model(
            "ashikhmin-normal",
            "the azimuth of the half vector is 0/0 at the normal",
            "ashikhmin:ex=10,ey=1000,Rs=0.5,Rd=0.1",
        ),
        model(
            "ggx-needle",
            "a metal of roughness 0.001",
            "ggx:ax=0.001,ay=0.001",
        ),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::Material;
    use merlkit::material::LookupRule;

    #[test]
    fn texts_are_materials_and_names_are_unique() {
        for (k, model) in HardModel::ALL.iter().enumerate() {
            let material = Material::resolve(model.text).unwrap();
            assert!(material.load(LookupRule::Floor).is_ok(), "{}", model.text);
            assert!(HardModel::ALL[..k].iter().all(|m| m.name != model.name));
        }
    }
}
