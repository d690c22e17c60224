//! Numbers as a reader wants them: three significant digits and a unit.

/// A time in seconds as milliseconds with three significant digits, without the unit.
pub(crate) fn milliseconds(seconds: f64) -> String {
    significant(seconds * 1e3)
}

/// A longer time with its unit: `850 ms`, `12.3 s`, `3 min 12 s`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round();
    if seconds < 1.0 {
        format!("{} ms", milliseconds(seconds))
    } else if whole < 60.0 {
        format!("{} s", significant(seconds))
    } else {
        format!("{} min {} s", (whole / 60.0).floor(), whole % 60.0)
    }
}

/// A number of bytes in binary units: `512 B`, `64.0 MiB`.
pub(crate) fn bytes(count: u64) -> String {
    if count < 1024 {
        return format!("{count} B");
    }
    let units = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    // Below 1024 after rounding to the digits shown: 1 048 575 B is 1.00 MiB, not 1024 KiB.
    let (mut value, mut unit) = (count as f64 / 1024.0, 0);
    while value >= 1023.5 && unit + 1 < units.len() {
        (value, unit) = (value / 1024.0, unit + 1);
    }
    format!("{} {}", significant(value), units[unit])
}

/// A signal-to-noise ratio in dB, without the unit; `∞` for equal images.
pub(crate) fn decibels(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "∞".to_owned() }
}

/// Whole numbers in groups of three digits, set apart by thin spaces that do not break: `262 144`.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Three significant digits, never in exponent form; whole numbers from 100 on.
pub(crate) fn significant(value: f64) -> String {
    let decimals = if value >= 99.95 {
        0
    } else if value >= 9.995 {
        1
    } else if value >= 0.9995 || value == 0.0 {
        2
    } else {
        // One more decimal for each leading zero; below a nanosecond's worth of milliseconds it is 0 anyway.
        (2 - value.log10().floor() as i32).clamp(3, 9) as usize
    };
    format!("{value:.decimals$}")
}

/// Text made safe for HTML, in elements and in quoted attributes.
pub(crate) fn html_escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_significant_digits() {
        let cases = [
            (0.0, "0.00"),
            (1e-6, "0.00100"),
            (0.000_123_4, "0.123"),
            (0.000_999_6, "1.00"),
            (0.004_567, "4.57"),
            (0.009_996, "10.0"),
            (0.012_34, "12.3"),
            (0.099_96, "100"),
            (1.234, "1234"),
        ];
        for (seconds, text) in cases {
            assert_eq!(milliseconds(seconds), text, "{seconds}");
        }
    }

    #[test]
    fn durations_and_bytes_change_unit() {
        let durations = [(0.25, "250 ms"), (12.34, "12.3 s"), (59.7, "1 min 0 s"), (192.0, "3 min 12 s")];
        for (seconds, text) in durations {
            assert_eq!(duration(seconds), text);
        }
        let sizes =
            [(0, "0 B"), (1023, "1023 B"), (1536, "1.50 KiB"), (1 << 26, "64.0 MiB"), ((1 << 20) - 1, "1.00 MiB")];
        for (count, text) in sizes {
            assert_eq!(bytes(count), text);
        }
        assert_eq!(bytes(u64::MAX), "16.0 EiB");
    }

    #[test]
    fn digits_are_grouped() {
        assert_eq!(grouped(7), "7");
        assert_eq!(grouped(262_144).replace('\u{202f}', "_"), "262_144");
        assert_eq!(grouped(1_000).replace('\u{202f}', "_"), "1_000");
    }

    #[test]
    fn markup_is_escaped() {
        assert_eq!(html_escape("<a b='c'>\"&"), "&lt;a b=&#39;c&#39;&gt;&quot;&amp;");
        assert_eq!(decibels(f64::INFINITY, 1), "∞");
    }
}
