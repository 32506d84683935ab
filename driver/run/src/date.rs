//! Dates for people.

use std::time::SystemTime;

/// The moment in Greenwich, as 2026-01-31 12:05 UTC.
pub fn moment(time: SystemTime) -> String {
    let minutes = time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs() / 60);
    format!("{} {:02}:{:02} UTC", day(time), minutes / 60 % 24, minutes % 60)
}

/// The day in Greenwich, as 2026-01-31.
pub fn day(time: SystemTime) -> String {
    let seconds = time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let mut days = seconds / 86_400;
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod test {
    use super::*;
    use std::time::Duration;

    #[test]
    fn days_are_those_of_the_calendar() {
        let on = |days: u64| day(SystemTime::UNIX_EPOCH + Duration::from_secs(86_400 * days + 3600));
        assert_eq!(on(0), "1970-01-01");
        assert_eq!(on(11_016), "2000-02-29");
        assert_eq!(on(11_017), "2000-03-01");
        assert_eq!(on(20_088), "2024-12-31");
        assert_eq!(on(20_089), "2025-01-01");
    }

    #[test]
    fn minutes_are_those_of_the_clock() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(86_400 * 20_088 + 3600 * 23 + 60 * 7 + 59);
        assert_eq!(moment(at), "2024-12-31 23:07 UTC");
    }
}
