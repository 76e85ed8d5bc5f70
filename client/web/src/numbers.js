const grouped = new Intl.NumberFormat('en-GB', {maximumFractionDigits: 0});

/** 1234567 -> "1,234,567". @param {number} value */
export const with_separators = (value) => grouped.format(value);

/** 84123 -> "84.1 kB". Decimal units, three digits. @param {number} bytes */
export function format_bytes(bytes) {
  const units = ['B', 'kB', 'MB', 'GB', 'TB', 'PB', 'EB', 'ZB'];
  let value = bytes;
  let unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    ++unit;
  }
  const digits = unit === 0 || value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
  return `${value.toFixed(digits)} ${units[unit]}`;
}

/** 1.23 -> "1.2 ms"; 84.1 -> "84 ms". @param {number} value */
export const format_milliseconds = (value) => `${value < 10 ? value.toFixed(1) : Math.round(value)} ms`;

/** At most two decimals, and none that are zero. @param {number} value */
export const short_decimal = (value) => String(Math.round(value * 100) / 100);

/** The largest of 1, 2, 5, 10, 20, … that is at most `limit`, never below 1. @param {number} limit */
export function round_number_below(limit) {
  if (limit < 1) return 1;
  const power = 10 ** Math.floor(Math.log10(limit));
  return [5, 2, 1].map((digit) => digit * power).find((value) => value <= limit) ?? power;
}

/** Whole numbers out of "1,234 5_678", whatever separates the groups; null if it is not a number. @param {string} text */
export function parse_grouped(text) {
  const digits = text.replace(/[\s,'’_]/g, '');
  return /^\d{1,15}$/.test(digits) ? Number(digits) : null;
}
