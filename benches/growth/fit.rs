//! Exponents: straight lines through the logarithms of sizes and of what they cost.

/// The exponent b of y ≈ a·xᵇ, and how far it may be off.
#[derive(Clone, Copy)]
pub struct Exponent {
    value: f64,
    /// Half the width of the 95 % confidence interval.
    reach: f64,
}

/// Exponents above this are pointed out.
const LINEAR: f64 = 1.05;

/// 97.5 % quantiles of Student's t distribution for 1, 2, … degrees of freedom.
const STUDENT: [f64; 8] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306];

impl Exponent {
    /// By least squares over points (x, y), all above 0; at least three.
    pub fn fit(points: &[(f64, f64)]) -> Self {
        let n = points.len() as f64;
        let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
        let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / n;
        let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / n;
        // b = Σ (x − x̄)(y − ȳ) / Σ (x − x̄)².
        let (mut xx, mut xy) = (0.0, 0.0);
        for (x, y) in &logs {
            xx += (x - mean_x).powi(2);
            xy += (x - mean_x) * (y - mean_y);
        }
        let value = xy / xx;
        // Its variance is that of the residuals over Σ (x − x̄)², with n − 2 degrees of freedom.
        let mut squares = 0.0;
        for (x, y) in &logs {
            squares += (y - mean_y - value * (x - mean_x)).powi(2);
        }
        let freedom = points.len().saturating_sub(2).clamp(1, STUDENT.len());
        let reach = STUDENT[freedom - 1] * (squares / freedom as f64 / xx).sqrt();
        Self { value, reach }
    }

    /// As a cell of a table, with a mark if it is above 1.05.
    pub fn cell(self) -> String {
        let text = format!("{:.2} ± {:.2}", self.value, self.reach);
        if self.value > LINEAR {
            format!("**{text}**")
        } else {
            text
        }
    }
}
