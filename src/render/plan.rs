//! Which effects a scene calls for, and why.

use super::spec::{SceneSpec, Strategy};
use super::visibility::{may_hide_lights, may_see_one_another};
use crate::light::{EnvironmentSource, LightSpec};

/// Something the renderer can do, and leaves out where no light depends on it.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Directions are drawn from the BRDFs' samplers, which have to be built.
    Directions,
    /// Directions are drawn towards lights with an extent.
    LightSampling,
    /// Tables that choose directions in proportion to an environment's radiance.
    EnvironmentTables,
    /// Both of these find the same light and are weighted (Veach 1997).
    Mis,
    /// One of several directions from the BRDF's sampler is kept for the light it finds (Talbot et al. 2005).
    Resampling,
    /// Objects hide lights from one another.
    Shadows,
    /// Objects light one another.
    Interreflection,
    /// Paths go on along mirror directions, which no density describes, from materials that reflect them.
    Mirrors,
    /// Long, weak paths end early, at random (Arvo and Kirk 1990).
    Roulette,
}

impl Effect {
    /// All effects, in the order in which they are explained.
    pub const ALL: [Self; 9] = [
        Self::Directions,
        Self::LightSampling,
        Self::EnvironmentTables,
        Self::Mis,
        Self::Resampling,
        Self::Shadows,
        Self::Interreflection,
        Self::Mirrors,
        Self::Roulette,
    ];

    /// Its name in explanations.
    pub fn name(self) -> &'static str {
        match self {
            Self::Directions => "BRDF directions",
            Self::LightSampling => "light sampling",
            Self::EnvironmentTables => "environment tables",
            Self::Mis => "multiple importance sampling",
            Self::Resampling => "resampling",
            Self::Shadows => "shadow rays",
            Self::Interreflection => "interreflection",
            Self::Mirrors => "mirror directions",
            Self::Roulette => "Russian roulette",
        }
    }
}

/// Whether something is on, and why.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// On or off.
    pub on: bool,
    /// The reason, as half a sentence.
    pub why: &'static str,
}

/// Which effects a scene is built with.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlanRequest {
    /// Those that it calls for.
    #[default]
    AsNeeded,
    /// Those that it calls for and one more, with what that one can't do without.
    Plus(Effect),
    /// All of them, and everything loaded.
    Everything,
}

/// Surfaces a path meets before roulette may end it.
pub(super) const ROULETTE_FROM: u32 = 3;

/// What a scene calls for: a decision on every effect, material and light, made from its description alone.
///
/// Every plan for a scene gives the same expected picture; they differ in cost. A [`super::Scene`] holds the plan that it was
/// built by, and is rendered by no other.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectPlan {
    effects: [Decision; Effect::ALL.len()],
    materials: Vec<Decision>,
    lights: Vec<Decision>,
}

impl EffectPlan {
    /// The plan that [`super::Scene::build`] makes for the same description and request. Nothing is loaded for it.
    pub fn for_scene(spec: &SceneSpec, request: PlanRequest) -> Self {
        let facts = SceneFacts::gather(spec);
        let mut materials = Vec::with_capacity(spec.materials.len());
        for i in 0..spec.materials.len() {
            materials.push(facts.decide_material(spec.uses_material(i)));
        }
        let mut plan = Self {
            effects: Effect::ALL.map(|effect| facts.decide(effect)),
            materials,
            lights: spec.lights.iter().map(|l| facts.decide_light(l)).collect(),
        };
        match request {
            PlanRequest::AsNeeded => {}
            PlanRequest::Plus(effect) => plan.force(effect),
            PlanRequest::Everything => plan.force_everything(),
        }
        plan
    }

    fn force_everything(&mut self) {
        for effect in Effect::ALL {
            self.force(effect);
        }
        for decision in self.materials.iter_mut().chain(&mut self.lights) {
            *decision = force(*decision);
        }
    }

    /// Forces an effect on, and what it can't do without.
    fn force(&mut self, effect: Effect) {
        let needs: &[Effect] = match effect {
            Effect::Mis => &[Effect::Directions, Effect::LightSampling],
            Effect::Resampling | Effect::Interreflection => &[Effect::Directions],
            _ => &[],
        };
        for needed in needs.iter().chain([&effect]) {
            let decision = &mut self.effects[*needed as usize];
            *decision = force(*decision);
        }
    }

    /// Whether an effect is on.
    pub fn is_on(&self, effect: Effect) -> bool {
        self.effect(effect).on
    }

    /// The decision on an effect.
    pub fn effect(&self, effect: Effect) -> Decision {
        self.effects[effect as usize]
    }

    /// The decision to load each of [`SceneSpec::materials`].
    pub fn materials(&self) -> &[Decision] {
        &self.materials
    }

    /// The decision to load each of [`SceneSpec::lights`].
    pub fn lights(&self) -> &[Decision] {
        &self.lights
    }
}

fn force(decision: Decision) -> Decision {
    if decision.on {
        decision
    } else {
        enabled("forced")
    }
}

const fn enabled(why: &'static str) -> Decision {
    Decision { on: true, why }
}

const fn disabled(why: &'static str) -> Decision {
    Decision { on: false, why }
}

/// Whether a light is an environment of equal radiance from everywhere.
fn is_constant(light: &LightSpec) -> bool {
    matches!(light, LightSpec::Environment(EnvironmentSource::Uniform(_)))
}

/// What decisions depend on.
#[derive(Clone, Copy)]
struct SceneFacts {
    objects: usize,
    /// Whether something may be between a surface and a light.
    hides: bool,
    /// Whether a surface may be seen from a surface.
    sees: bool,
    /// Whether a light is not dark.
    lit: bool,
    /// Whether one of these has an extent.
    extended: bool,
    /// Whether one of these is an environment.
    environment: bool,
    /// Whether an environment among them differs between directions.
    varied: bool,
    /// Whether all that have an extent are environments that don't.
    all_constant: bool,
    /// Whether an object is made of a material that reflects mirror directions.
    mirrors: bool,
    depth: u32,
    strategy: Strategy,
}

impl SceneFacts {
    fn gather(spec: &SceneSpec) -> Self {
        let shining: Vec<&LightSpec> = spec.lights.iter().filter(|l| !l.is_dark()).collect();
        Self {
            objects: spec.shapes().len(),
            hides: may_hide_lights(spec),
            sees: may_see_one_another(spec),
            lit: !shining.is_empty(),
            extended: shining.iter().any(|l| !l.is_delta()),
            environment: shining.iter().any(|l| l.is_environment()),
            varied: shining
                .iter()
                .any(|l| l.is_environment() && !is_constant(l)),
            all_constant: shining.iter().all(|l| l.is_delta() || is_constant(l)),
            mirrors: spec.mirrors.iter().any(|&i| spec.uses_material(i)),
            depth: spec.depth,
            strategy: spec.strategy,
        }
    }

    fn decide(self, effect: Effect) -> Decision {
        if !self.lit {
            return disabled("no light");
        }
        if self.objects == 0 {
            return disabled("no object");
        }
        match effect {
            Effect::Directions => self.directions(),
            Effect::LightSampling => self.light_sampling(),
            Effect::EnvironmentTables => self.environment_tables(),
            Effect::Mis => self.mis(),
            Effect::Resampling => self.resampling(),
            Effect::Shadows => self.shadows(),
            Effect::Interreflection => self.interreflection(),
            Effect::Mirrors => self.mirrors(),
            Effect::Roulette => self.roulette(),
        }
    }

    fn directions(self) -> Decision {
        match (
            self.extended && self.strategy != Strategy::Light,
            self.interreflection().on,
        ) {
            (true, _) => enabled("a light has an extent that directions can hit"),
            (false, true) => enabled("objects light one another"),
            (false, false) if self.extended => {
                disabled("the lights are sampled, and nothing else is lit")
            }
            (false, false) => disabled("delta lights only: a random direction never hits them"),
        }
    }

    fn light_sampling(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => disabled("delta lights only: they are evaluated, not sampled"),
            (true, Strategy::Brdf | Strategy::Ris { .. }) => {
                disabled("the strategy draws directions from the BRDF only")
            }
            (true, Strategy::Mis(_)) if self.all_constant => disabled(
                "a constant environment is as bright wherever a direction of the BRDF goes",
            ),
            (true, _) => enabled("a light has an extent"),
        }
    }

    fn environment_tables(self) -> Decision {
        match (self.environment, self.strategy) {
            (false, _) => disabled("no environment"),
            (true, _) if !self.varied => disabled("a constant environment needs no tables"),
            (true, Strategy::Brdf | Strategy::Ris { .. }) => {
                disabled("the strategy draws directions from the BRDF only")
            }
            (true, _) => enabled("the environment is sampled"),
        }
    }

    fn mis(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => disabled("delta lights only: one technique"),
            (true, Strategy::Mis(_)) if !self.light_sampling().on => disabled("one technique"),
            (true, Strategy::Mis(_)) => enabled("two techniques find the same light"),
            (true, _) => disabled("the strategy uses one technique"),
        }
    }

    fn resampling(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => disabled("delta lights only: a random direction never hits them"),
            (true, Strategy::Ris { candidates: 0 | 1 }) => {
                disabled("one candidate: nothing to choose")
            }
            (true, Strategy::Ris { .. }) => {
                enabled("of several directions, the one that is kept is likely to carry much light")
            }
            (true, _) => disabled("the strategy takes each direction as it is drawn"),
        }
    }

    fn shadows(self) -> Decision {
        if !self.hides && self.objects == 1 {
            disabled("one convex object hides no light from itself")
        } else if !self.hides {
            disabled("a plane is between each object and all that goes from another to a light")
        } else if self.objects == 1 {
            enabled("an object that is not convex hides light from itself")
        } else {
            enabled("several objects hide lights from one another")
        }
    }

    fn interreflection(self) -> Decision {
        if !self.sees && self.objects == 1 {
            disabled("one convex object does not light itself")
        } else if !self.sees {
            disabled("all objects are in one plane")
        } else if self.depth <= 1 {
            disabled("depth 1: direct light only")
        } else if self.objects == 1 {
            enabled("an object that is not convex lights itself")
        } else {
            enabled("several objects light one another")
        }
    }

    fn mirrors(self) -> Decision {
        if !self.mirrors {
            disabled("no material has a part that reflects the mirror direction alone")
        } else if self.extended {
            enabled(
                "mirror directions find lights with an extent, without weights: no other technique does",
            )
        } else if self.interreflection().on {
            enabled("mirror directions find other objects")
        } else {
            disabled("delta lights only, and nothing else to be seen in a mirror")
        }
    }

    fn roulette(self) -> Decision {
        if !self.interreflection().on {
            disabled("paths end at the first surface")
        } else if self.depth <= ROULETTE_FROM {
            disabled("paths are short")
        } else {
            enabled("paths can be long")
        }
    }

    fn decide_material(self, used: bool) -> Decision {
        match (used, self.lit) {
            (true, true) => enabled("an object is made of it"),
            (true, false) => disabled("no light falls on it"),
            (false, _) => disabled("no object is made of it"),
        }
    }

    fn decide_light(self, light: &LightSpec) -> Decision {
        if light.is_dark() {
            disabled("it is dark")
        } else if self.objects == 0 && light.is_delta() {
            disabled("no object for it to fall on")
        } else {
            enabled("it shines")
        }
    }
}
