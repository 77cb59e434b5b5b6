//! Which effects a scene calls for, and why.

use super::{SceneSpec, Strategy, spec::LightSpec};

/// Something the renderer can do, and leaves out where no light depends on it.
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
    /// Long, weak paths end early, at random (Arvo and Kirk 1990).
    Roulette,
}

impl Effect {
    /// All effects, in the order in which they are explained.
    pub const ALL: [Self; 8] = [
        Self::Directions,
        Self::LightSampling,
        Self::EnvironmentTables,
        Self::Mis,
        Self::Resampling,
        Self::Shadows,
        Self::Interreflection,
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
            Self::Roulette => "Russian roulette",
        }
    }
}

/// Whether something is on, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// On or off.
    pub on: bool,
    /// The reason, as half a sentence.
    pub why: &'static str,
}

/// Surfaces a path meets before roulette may end it.
pub(super) const ROULETTE_FROM: u32 = 3;

/// What a scene calls for: a decision on every effect, material and light, made from its description alone.
///
/// Every plan that this module can make for a scene gives the same expected picture; they differ in cost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectPlan {
    effects: [Decision; Effect::ALL.len()],
    materials: Vec<Decision>,
    lights: Vec<Decision>,
}

impl EffectPlan {
    /// The effects that `spec` calls for.
    pub fn of(spec: &SceneSpec) -> Self {
        let facts = Facts::of(spec);
        Self {
            effects: Effect::ALL.map(|effect| facts.decide(effect)),
            materials: (0..spec.materials.len())
                .map(|i| material(spec, facts, i))
                .collect(),
            lights: spec
                .lights
                .iter()
                .map(|light| self::light(facts, light))
                .collect(),
        }
    }

    /// Everything on, and everything loaded.
    pub fn everything(spec: &SceneSpec) -> Self {
        let plan = Effect::ALL.into_iter().fold(Self::of(spec), Self::with);
        Self {
            effects: plan.effects,
            materials: plan.materials.into_iter().map(force).collect(),
            lights: plan.lights.into_iter().map(force).collect(),
        }
    }

    /// This plan with `effect` forced on, and what it can't do without.
    #[must_use]
    pub fn with(mut self, effect: Effect) -> Self {
        let needs: &[Effect] = match effect {
            Effect::Mis => &[Effect::Directions, Effect::LightSampling],
            Effect::Resampling | Effect::Interreflection => &[Effect::Directions],
            _ => &[],
        };
        for e in needs.iter().chain([&effect]) {
            let decision = &mut self.effects[*e as usize];
            *decision = force(*decision);
        }
        self
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
    if decision.on { decision } else { on("forced") }
}

const fn on(why: &'static str) -> Decision {
    Decision { on: true, why }
}

const fn off(why: &'static str) -> Decision {
    Decision { on: false, why }
}

/// What decisions depend on.
#[derive(Clone, Copy)]
struct Facts {
    objects: usize,
    /// Lights that are not dark.
    lit: bool,
    /// One of them has an extent.
    extended: bool,
    environment: bool,
    depth: u32,
    strategy: Strategy,
}

impl Facts {
    fn of(spec: &SceneSpec) -> Self {
        let used = || spec.lights.iter().filter(|l| !l.is_dark());
        Self {
            objects: spec.spheres.len() + usize::from(spec.floor.is_some()),
            lit: used().next().is_some(),
            extended: used().any(|l| !l.is_delta()),
            environment: used().any(|l| matches!(l, LightSpec::Environment(_))),
            depth: spec.depth,
            strategy: spec.strategy,
        }
    }

    fn decide(self, effect: Effect) -> Decision {
        if !self.lit {
            return off("no light");
        }
        if self.objects == 0 {
            return off("no object");
        }
        match effect {
            Effect::Directions => self.directions(),
            Effect::LightSampling => self.light_sampling(),
            Effect::EnvironmentTables => self.environment_tables(),
            Effect::Mis => self.mis(),
            Effect::Resampling => self.resampling(),
            Effect::Shadows => self.shadows(),
            Effect::Interreflection => self.interreflection(),
            Effect::Roulette => self.roulette(),
        }
    }

    fn directions(self) -> Decision {
        match (
            self.extended && self.strategy != Strategy::Light,
            self.interreflection().on,
        ) {
            (true, _) => on("a light has an extent that directions can hit"),
            (false, true) => on("objects light one another"),
            (false, false) if self.extended => {
                off("the lights are sampled, and nothing else is lit")
            }
            (false, false) => off("delta lights only: no direction drawn by chance can hit them"),
        }
    }

    fn light_sampling(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => off("delta lights only: they are evaluated, not sampled"),
            (true, Strategy::Brdf | Strategy::Ris { .. }) => {
                off("the strategy draws directions from the BRDF only")
            }
            (true, _) => on("a light has an extent"),
        }
    }

    fn environment_tables(self) -> Decision {
        match (self.environment, self.strategy) {
            (false, _) => off("no environment"),
            (true, Strategy::Brdf | Strategy::Ris { .. }) => {
                off("the strategy draws directions from the BRDF only")
            }
            (true, _) => on("the environment is sampled"),
        }
    }

    fn mis(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => off("delta lights only: one technique"),
            (true, Strategy::Mis(_)) => on("two techniques find the same light"),
            (true, _) => off("the strategy uses one technique"),
        }
    }

    fn resampling(self) -> Decision {
        match (self.extended, self.strategy) {
            (false, _) => off("delta lights only: no direction drawn by chance can hit them"),
            (true, Strategy::Ris { candidates: 0 | 1 }) => off("one candidate: nothing to choose"),
            (true, Strategy::Ris { .. }) => {
                on("of several directions, the one kept is likely to find much light")
            }
            (true, _) => off("the strategy takes each direction as it is drawn"),
        }
    }

    fn shadows(self) -> Decision {
        if self.objects == 1 {
            off("one convex object hides no light from itself")
        } else {
            on("several objects hide lights from one another")
        }
    }

    fn interreflection(self) -> Decision {
        match (self.objects, self.depth) {
            (1, _) => off("one convex object does not light itself"),
            (_, 0..=1) => off("depth 1: direct light only"),
            _ => on("several objects light one another"),
        }
    }

    fn roulette(self) -> Decision {
        if !self.interreflection().on {
            off("paths end at the first surface")
        } else if self.depth <= ROULETTE_FROM {
            off("paths are short")
        } else {
            on("paths can be long")
        }
    }
}

fn material(spec: &SceneSpec, facts: Facts, index: usize) -> Decision {
    match (spec.spheres.iter().any(|s| s.material == index), facts.lit) {
        (true, true) => on("a sphere is made of it"),
        (true, false) => off("no light falls on it"),
        (false, _) => off("no sphere is made of it"),
    }
}

fn light(facts: Facts, light: &LightSpec) -> Decision {
    if light.is_dark() {
        off("it is dark")
    } else if facts.objects == 0 && light.is_delta() {
        off("no object for it to fall on")
    } else {
        on("it shines")
    }
}
