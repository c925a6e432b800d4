/**
 * The language of the dashboard: chosen once, before any page is drawn. The texts are English
 * until the catalogue of the chosen language is there, so no module may keep one of them aside
 * while it is loaded. Another choice loads the page anew. Only who reads Spanish loads Spanish.
 */

export const languages = ['en', 'es'] as const;
export type Language = (typeof languages)[number];
export type Catalogue = typeof import('./es');

/** What each language calls itself. */
export const languageNames: Record<Language, string> = { en: 'English', es: 'Español' };

const key = 'binnacle-language';

/** The first language that there is a catalogue of: as chosen here, else as the browser says. */
export function languageOf(chosen: string | null, wanted: readonly string[]): Language {
  for (const tag of [chosen ?? '', ...wanted]) {
    const found = languages.find((language) => language === tag.toLowerCase().split('-')[0]);
    if (found) return found;
  }
  return 'en';
}

let catalogue: Catalogue | undefined;
const waiting: ((catalogue: Catalogue) => void)[] = [];

/** The language that the page is in. */
export const language = (): Language => (catalogue ? 'es' : 'en');

/** The texts exported under a name, in the language of the page. */
/* @__NO_SIDE_EFFECTS__ */
export function translate<T extends object>(name: keyof Catalogue, english: T): T {
  if (catalogue) return catalogue[name] as T;
  waiting.push((spanish) => Object.assign(english, spanish[name]));
  return english;
}

/** Puts single texts into the language of the page. */
export function onCatalogue(put: (catalogue: Catalogue) => void): void {
  if (catalogue) put(catalogue);
  else waiting.push(put);
}

/** Puts all texts into Spanish, those that are loaded and those that will be. */
export function useCatalogue(spanish: Catalogue): void {
  catalogue = spanish;
  for (const put of waiting.splice(0)) put(spanish);
}

/** Loads the catalogue of the reader's language. Without a connection it stays English. */
export async function loadLanguage(): Promise<void> {
  if (languageOf(stored(), navigator.languages) === 'es') {
    const spanish = await import('./es').catch(() => undefined);
    if (spanish) useCatalogue(spanish);
  }
  document.documentElement.lang = language();
}

/** Keeps another choice in this browser, and loads the page anew in it. */
export function chooseLanguage(chosen: Language): void {
  try {
    localStorage.setItem(key, chosen);
  } catch {
    // Without storage the page stays as the browser wants it.
  }
  location.reload();
}

function stored(): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}
