//! Numbers as people write them, for the sentences of errors, warnings and summaries.

/// A whole number with separators: `86,412`.
pub(crate) fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Four significant digits, without an exponent where a person would write none.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{}", x + 0.0);
    }
    let magnitude = x.abs().log10().floor();
    if !(-5.0..9.0).contains(&magnitude) {
        let text = format!("{x:.3e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        return format!("{digits}e{exponent}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{x:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let (sign, whole) = whole.strip_prefix('-').map_or(("", whole), |w| ("-", w));
    let whole = whole.parse().map_or_else(|_| whole.to_string(), count);
    if fraction.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
}

/// Two significant digits, rounded up, as something one can type: `0.42`, `1300`.
pub(crate) fn rounded_up(x: f64) -> String {
    significant(x, f64::ceil)
}

/// Two significant digits, rounded down, as something one can type.
pub(crate) fn rounded_down(x: f64) -> String {
    significant(x, f64::floor)
}

fn significant(x: f64, round: fn(f64) -> f64) -> String {
    if !(x.is_finite() && x > 0.0) {
        return x.to_string();
    }
    let exponent = x.log10().floor() as i32 - 1;
    // A number such as 0.3 must not become 0.31 by the error of the division.
    let digits = (x / 10_f64.powi(exponent) * 1e6).round() / 1e6;
    let typed = format!("{}e{exponent}", round(digits));
    match typed.parse::<f64>() {
        // Nobody counts twenty zeros.
        Ok(v) if !(1e-6..1e9).contains(&v) => format!("{v:e}"),
        Ok(v) => v.to_string(),
        Err(_) => x.to_string(),
    }
}

/// Six significant digits, without zeros at the end, as something one can type: `0.0393701`, `25.4`.
#[cfg(feature = "cli")]
pub(crate) fn factor(x: f64) -> String {
    format!("{x:.5e}").parse::<f64>().map_or_else(|_| x.to_string(), |rounded| rounded.to_string())
}
