/**
 * What the server says of a value that it refuses, in the words of the forms: it names
 * fields as its document does (`steps[2].reading_ut`), for programs.
 */

import * as text from '../text';

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.fields;

/** How the server begins when it could not read a body, and how it ends. */
const unread = /^body: Failed to deserialize the JSON body into the target type: /;
const place = / at line \d+ column \d+$/;
const part = String.raw`[A-Za-z_]\w*(?:\[\d+\])*`;
const named = new RegExp(String.raw`^(${part}(?:(?:\.|, )(?:${part}|\d+))*): (.+)$`, 's');

/** The sentence for a refusal; what is not of that form stays as it is. */
export function invalidInWords(detail: string): string {
  const said = detail.replace(unread, '').replace(place, '');
  const [, path = '', what = said] = named.exec(said) ?? [];
  const [, how, field] = /^(missing|unknown) field `(\w+)`/.exec(what) ?? [];
  if (field !== undefined) {
    const whole = label(path === '' ? field : `${path}.${field}`);
    return t().refused(whole, how === 'missing' ? t().missing : t().unknown);
  }
  if (path === '') return said;
  const plain = inWords(what).replace(/\.$/, '');
  const isPredicate = /^(is|has|have|are|must|comes?|begins?|ends?|stands?|was|were) /.test(plain);
  return (isPredicate ? t().refused : t().said)(label(path), plain);
}

function inWords(what: string): string {
  if (what.startsWith('unknown variant ')) return t().choice;
  const [, wanted] = /^invalid (?:type|value): .*, expected (.+)$/s.exec(what) ?? [];
  if (wanted === undefined) return what;
  if (/^(u8|u16|u32|u64|usize)$/.test(wanted)) return t().whole;
  if (/^(f32|f64|i\d+|a number)/.test(wanted)) return t().number;
  if (/^a (borrowed )?string/.test(wanted)) return t().text;
  if (wanted.startsWith('a boolean')) return t().yesOrNo;
  return what;
}

/** `steps[2].reading_ut` as `Step 3, Reading`. */
export function label(path: string): string {
  const parts = path.split(/\.|, /).map((one) => {
    const [, name = one, indices = ''] = /^(\w+?)((?:\[\d+\])*)$/.exec(one) ?? [];
    const places = [...indices.matchAll(/\d+/g)].map(([digits]) => Number(digits) + 1);
    const whole = called(places.length > 0 ? singular(name) : name);
    return places.reduce((so, place) => t().nth(so, place), whole);
  });
  return parts.join(', ');
}

function called(name: string): string {
  if (Object.hasOwn(t().labels, name)) return t().labels[name] ?? name;
  const words = name.split('_');
  const unit = words.at(-1) ?? '';
  const hasUnit = words.length > 1 && Object.hasOwn(t().units, unit);
  const said = (hasUnit ? words.slice(0, -1) : words).join(' ');
  const plain = said.charAt(0).toUpperCase() + said.slice(1);
  return hasUnit ? `${plain} (${t().units[unit] ?? ''})` : plain;
}

function singular(name: string): string {
  return name.endsWith('s') && !name.endsWith('ss') ? name.slice(0, -1) : name;
}
