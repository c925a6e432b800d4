/** Ports as they are written: by name with their UN/LOCODE behind it. Pure functions. */

/** `Rotterdam (NLRTM)`. */
export const portWritten = ({ code, name }: { code: string; name: string }): string =>
  name === '' || name === code ? code : `${name} (${code})`;

/** A sentence in which codes that stand alone give way to the ports' names, where known. */
export const portsNamed = (words: string, nameOf: (code: string) => string | undefined): string =>
  words.replace(/(?<![(\w])[A-Z]{2}[A-Z2-9]{3}(?![)\w])/g, (code) => nameOf(code) ?? code);

/** The UN/LOCODE that words name, alone or behind the name; an order may say its port otherwise. */
export const codeOf = (words: string | null | undefined): string | undefined =>
  /^(?:.*\()?([A-Z]{2}[A-Z2-9]{3})\)?$/.exec(words?.trim() ?? '')?.[1];
