/** The help and what is found in it. Pure. */

import { plainly } from './plainly';

/** A topic as it is listed. */
export interface Topic {
  id: string;
  title: string;
  /** How it begins. */
  lead: string;
  /** The topic as HTML, made from our own documents when the dashboard is built. */
  load: () => Promise<string>;
}

/** A topic as it is searched. */
export interface Searched {
  id: string;
  title: string;
  sections: {
    /** Empty for what comes before the first heading. */
    id: string;
    title: string;
    text: string;
  }[];
}

export interface Passage {
  topic: Searched;
  section: Searched['sections'][number];
  /** The words around the first one found. */
  excerpt: string;
}

/** The section that an address's hash names; as it stands where it is written wrongly. */
export function sectionOf(hash: string): string {
  try {
    return decodeURIComponent(hash.slice(1));
  } catch {
    return hash.slice(1);
  }
}

/** So many passages are listed. */
const mostFound = 20;
/** So many letters before what was found, and so many in all. */
const [before, length] = [60, 220];

/** The passages with every word sought, those with one in a title first. */
export function passages(topics: readonly Searched[], query: string): Passage[] {
  const words = plainly(query)
    .split(/\s+/)
    .filter((word) => word !== '');
  if (words.length === 0) return [];
  return topics
    .flatMap((topic) => topic.sections.map((section) => ({ topic, section })))
    .flatMap(({ topic, section }) => {
      const title = plainly(`${topic.title} ${section.title}`);
      const text = plainly(section.text);
      if (!words.every((word) => title.includes(word) || text.includes(word))) return [];
      const titled = words.filter((word) => title.includes(word)).length;
      return [{ topic, section, titled, excerpt: excerptOf(section.text, words) }];
    })
    .sort((a, b) => b.titled - a.titled)
    .slice(0, mostFound);
}

function excerptOf(text: string, words: readonly string[]): string {
  const places = words.map((word) => plainly(text).indexOf(word)).filter((place) => place >= 0);
  const from = Math.max(0, Math.min(...places, text.length) - before);
  const cut = text.slice(from === text.length ? 0 : from).slice(0, length);
  return `${from > 0 ? '…' : ''}${cut.trim()}${cut.length === length ? '…' : ''}`;
}
