//! Numbers as text: exact for files, rounded for people.

/// The longest text that [`push_exact`] writes.
pub const EXACT_LENGTH: usize = 24;

/// Appends the shortest text that reads back to the same double; `nan`, `inf`, `-inf`.
#[inline]
pub fn push_exact(line: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        let mut buffer = ryu::Buffer::new();
        let text = buffer.format_finite(value).as_bytes();
        line.extend_from_slice(text.strip_suffix(b".0").unwrap_or(text));
    } else if value.is_nan() {
        line.extend_from_slice(b"nan");
    } else {
        line.extend_from_slice(if value > 0.0 { b"inf" } else { b"-inf" });
    }
}

/// The shortest text that reads back to the same double, with an exponent where it is tiny or huge.
pub fn exact(value: f64) -> String {
    let mut text = Vec::with_capacity(EXACT_LENGTH);
    push_exact(&mut text, value);
    String::from_utf8_lossy(&text).into_owned()
}

/// Appends an integer.
#[inline]
pub fn push_integer(line: &mut Vec<u8>, mut value: u32) {
    let mut digits = [0u8; 10];
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    line.extend_from_slice(&digits[first..]);
}

/// Five significant digits for tables that people read: `-27.6`, `0.00155`, `3.25·10⁻⁷`.
pub fn rounded(value: f64) -> String {
    significant(value, 5)
}

/// A number with at most so many significant digits, trailing zeros dropped.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { signed(value.to_string()) };
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        signed(trimmed(&format!("{value:.decimals$}")).to_owned())
    } else {
        signed(format!("{}·10{}", trimmed(mantissa), superscript(exponent)))
    }
}

/// A real minus sign.
pub fn signed(text: String) -> String {
    match text.strip_prefix('-') {
        Some(magnitude) => format!("−{magnitude}"),
        None => text,
    }
}

/// An exponent in superscript.
pub fn superscript(exponent: i32) -> String {
    let raise = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + (digit as u32 - '0' as u32)).unwrap_or(digit),
    };
    exponent.to_string().chars().map(raise).collect()
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}
