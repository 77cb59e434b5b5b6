//! Axes: which values lie where, and at which of them stands a tick.

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly. Values from −10³⁰⁰ to 10³⁰⁰.
    #[default]
    Linear,
    /// By their logarithms. Values > 0.
    Log,
    /// By their square roots. Values ≥ 0.
    Root,
}

/// Values beyond are not drawn: their differences would overflow.
const LARGEST: f64 = 1e300;

impl Scale {
    /// Where a value lies along the axis, in units of its own; `None` if it lies nowhere.
    pub(super) fn transform(self, value: f64) -> Option<f64> {
        if value.is_nan() || value.abs() > LARGEST {
            return None;
        }
        match self {
            Self::Linear => Some(value),
            Self::Log => (value > 0.0).then(|| value.log10()),
            Self::Root => (value >= 0.0).then(|| value.sqrt()),
        }
    }
}

/// An axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// How values are spread.
    pub scale: Scale,
    /// First and last value; `None`, or a range that is empty or outside the scale, takes what the data need.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis as long as the data need.
    pub fn new(title: impl Into<String>, scale: Scale) -> Self {
        Self {
            title: title.into(),
            scale,
            range: None,
        }
    }

    /// The same from `low` to `high`; what lies outside is cut off.
    pub fn with_range(self, low: f64, high: f64) -> Self {
        Self {
            range: Some((low, high)),
            ..self
        }
    }
}

impl Axis {
    /// The value at a fraction of the axis's length from its lower end; NaN without a range.
    pub(super) fn value_at(&self, fraction: f64) -> f64 {
        let ends = self.range.and_then(|(low, high)| {
            let scale = self.scale;
            Some((scale.transform(low)?, scale.transform(high)?))
        });
        let Some((low, high)) = ends else {
            return f64::NAN;
        };
        let place = low + fraction * (high - low);
        match self.scale {
            Scale::Linear => place,
            Scale::Log => 10f64.powf(place),
            Scale::Root => place * place,
        }
    }
}

/// A tick, with its label if it has one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// Pixel.
    pub at: f64,
    pub label: Option<String>,
}

/// An axis laid along pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ruler {
    scale: Scale,
    /// Ends, as [`Scale::transform`] gives them.
    low: f64,
    high: f64,
    /// Pixels of the ends.
    start: f64,
    end: f64,
}

/// Shortest distance of labels, pixels, along an axis that runs across and one that runs upwards.
const SPACING: [f64; 2] = [56.0, 30.0];

impl Ruler {
    /// From `start` to `end`, in pixels; `None` if there is neither a range nor a value.
    pub fn new(
        axis: &Axis,
        values: impl Iterator<Item = f64>,
        start: f64,
        end: f64,
    ) -> Option<Self> {
        let scale = axis.scale;
        let ruler = |low, high| Self {
            scale,
            low,
            high,
            start,
            end,
        };
        let given = axis
            .range
            .and_then(|(low, high)| Some((scale.transform(low)?, scale.transform(high)?)));
        if let Some((low, high)) = given.filter(|&(low, high)| is_wide(low, high)) {
            return Some(ruler(low, high));
        }
        let (low, high) = values
            .filter_map(|v| scale.transform(v))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        (low <= high).then(|| {
            let (low, high) = widened(low, high);
            let (low, high) = match scale {
                Scale::Linear => rounded(low, high),
                Scale::Log => (rounded_down(low), rounded_up(high)),
                Scale::Root => (low.max(0.0), high),
            };
            ruler(low, high)
        })
    }

    /// Pixel of a value, which may lie beyond the ends; `None` if the axis can't hold it.
    pub fn pixel_of(&self, value: f64) -> Option<f64> {
        self.scale.transform(value).map(|p| self.pixel(p))
    }

    /// Pixel of the axis's lower end.
    pub fn bottom(&self) -> f64 {
        self.start
    }

    fn pixel(&self, place: f64) -> f64 {
        self.start + (place - self.low) / (self.high - self.low) * (self.end - self.start)
    }

    /// Ticks within the axis, in rising order.
    pub fn ticks(&self) -> Vec<Tick> {
        let across = self.end > self.start;
        let spacing = SPACING[usize::from(!across)];
        let most = ((self.end - self.start).abs() / spacing).max(2.0);
        match self.scale {
            Scale::Linear => self.linear_ticks(most),
            Scale::Log => self.log_ticks(most),
            Scale::Root => self.root_ticks(spacing * 0.6),
        }
    }

    fn linear_ticks(&self, most: f64) -> Vec<Tick> {
        let step = nice_step((self.high - self.low) / most);
        let first = (self.low / step - 1e-6).ceil();
        let count = ((self.high - first * step) / step + 1e-6)
            .floor()
            .clamp(0.0, 100.0) as usize;
        let mut ticks = Vec::new();
        for i in 0..=count {
            let value = (first + i as f64) * step;
            ticks.push(Tick {
                at: self.pixel(value),
                label: Some(number(value, step)),
            });
        }
        ticks
    }

    fn log_ticks(&self, most: f64) -> Vec<Tick> {
        const ROUNDING: f64 = 1e-9;
        let decades = self.high - self.low;
        let every = (decades / most).ceil().max(1.0) as i32;
        let (first, last) = (
            (self.low - ROUNDING).floor() as i32,
            (self.high + ROUNDING).floor() as i32,
        );
        let plain = first >= -3 && last <= 4;
        let within = self.low - ROUNDING..=self.high + ROUNDING;
        let mut ticks = Vec::new();
        for exponent in first..=last {
            let labelled = exponent.rem_euclid(every) == 0;
            for digit in 1..10u8 {
                let place = f64::from(exponent) + f64::from(digit).log10();
                // Decades that have no label still have a tick, unless there are hundreds.
                let shown = if digit == 1 {
                    labelled || every <= 5
                } else {
                    every == 1
                };
                if !shown || !within.contains(&place) {
                    continue;
                }
                let named = if digit == 1 {
                    labelled
                } else {
                    decades <= most / 4.0 && matches!(digit, 2 | 5)
                };
                let label = named.then(|| power(digit, exponent, plain));
                ticks.push(Tick {
                    at: self.pixel(place),
                    label,
                });
            }
        }
        ticks
    }

    /// 0, an end that is a whole number up to 100, and 1, 2 and 5 times powers of ten from the top, as far as they are `spacing`
    /// apart.
    fn root_ticks(&self, spacing: f64) -> Vec<Tick> {
        let mut ticks = Vec::new();
        self.push_root_tick(&mut ticks, 0.0, spacing);
        // An end that was chosen, such as 90°, and not where the data happen to end.
        let end = self.high * self.high;
        let round = end.round();
        if (1.0..=100.0).contains(&round) && (end - round).abs() < 1e-9 * end {
            self.push_root_tick(&mut ticks, round, spacing);
        }
        let top = (2.0 * self.high.log10()).floor().clamp(-300.0, 300.0) as i32;
        for exponent in (top - 6..=top).rev() {
            for digit in [5.0, 2.0, 1.0] {
                self.push_root_tick(&mut ticks, digit * 10f64.powi(exponent), spacing);
            }
        }
        ticks.sort_by(|a, b| a.at.total_cmp(&b.at));
        ticks
    }

    /// Adds a tick of a root axis if its value lies on the axis, `spacing` or more from the others.
    fn push_root_tick(&self, ticks: &mut Vec<Tick>, value: f64, spacing: f64) {
        let place = value.sqrt();
        let at = self.pixel(place);
        let on_axis = place <= self.high * (1.0 + 1e-9) && place >= self.low;
        if on_axis && ticks.iter().all(|t| (t.at - at).abs() >= spacing) {
            ticks.push(Tick {
                at,
                label: Some(number(value, value)),
            });
        }
    }
}

/// Whether two ends are far enough apart to tell values between them.
fn is_wide(low: f64, high: f64) -> bool {
    high - low > 1e-9 * low.abs().max(high.abs()).max(1e-290)
}

/// Ends that are far enough apart, around the same middle.
fn widened(low: f64, high: f64) -> (f64, f64) {
    if is_wide(low, high) {
        return (low, high);
    }
    let reach = (0.1 * low.abs().max(high.abs())).max(0.3);
    (low - reach, high + reach)
}

/// Ends moved outwards to multiples of a tick's step; to 0 where that is near.
fn rounded(low: f64, high: f64) -> (f64, f64) {
    let low = if low > 0.0 && low < 0.4 * high {
        0.0
    } else {
        low
    };
    let step = nice_step((high - low) / 6.0);
    (
        (low / step + 1e-6).floor() * step,
        (high / step - 1e-6).ceil() * step,
    )
}

/// The next of 1, 2, 5, 10 … from `place`, a logarithm, downwards.
fn rounded_down(place: f64) -> f64 {
    let decade = (place + 1e-9).floor();
    let below = [5f64, 2.0, 1.0]
        .into_iter()
        .map(|d| decade + d.log10())
        .find(|&p| p <= place + 1e-9);
    below.unwrap_or(decade)
}

/// The next of 1, 2, 5, 10 … from `place`, a logarithm, upwards.
fn rounded_up(place: f64) -> f64 {
    let decade = (place + 1e-9).floor();
    let above = [1f64, 2.0, 5.0]
        .into_iter()
        .map(|d| decade + d.log10())
        .find(|&p| p >= place - 1e-9);
    above.unwrap_or(decade + 1.0)
}

/// The least of 1, 2, 5 times a power of ten that is not below `step` > 0.
fn nice_step(step: f64) -> f64 {
    let decade = 10f64.powi(step.log10().floor().clamp(-300.0, 300.0) as i32);
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|d| d * decade)
        .find(|&s| s >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// A value as ticks of a linear axis show it: with the decimals that `step` has.
pub(super) fn number(value: f64, step: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.abs() >= 1e5 || step.abs() < 1e-4 {
        return scientific(value);
    }
    let decimals = (-(step.abs().log10() + 1e-9).floor()).clamp(0.0, 8.0) as usize;
    minus(&format!("{value:.decimals$}"))
}

/// "2.5×10⁷".
fn scientific(value: f64) -> String {
    let text = format!("{value:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    let exponent = superscript(exponent.parse().unwrap_or(0));
    if mantissa == "1" {
        format!("10{exponent}")
    } else {
        minus(&format!("{mantissa}×10{exponent}"))
    }
}

/// `digit` times ten to the `exponent`.
fn power(digit: u8, exponent: i32, plain: bool) -> String {
    if plain {
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        return format!("{:.decimals$}", f64::from(digit) * 10f64.powi(exponent));
    }
    let ten = format!("10{}", superscript(exponent));
    if digit == 1 {
        ten
    } else {
        format!("{digit}·{ten}")
    }
}

fn superscript(n: i32) -> String {
    n.to_string().chars().map(raise).collect()
}

/// A digit or a minus sign as an exponent.
fn raise(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c
            .to_digit(10)
            .and_then(|d| char::from_u32(0x2070 + d))
            .unwrap_or(c),
    }
}

/// With a true minus sign.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}
