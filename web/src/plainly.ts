/** Words as they are searched for. Pure. */

/** Letters that no mark is taken from to have a plain one. */
const otherLetters: Record<string, string> = { ø: 'o', ł: 'l', đ: 'd', æ: 'ae', œ: 'oe', ß: 'ss' };

/** Without capitals and accents: not every keyboard has every ship's letters. */
export const plainly = (words: string): string =>
  words
    .normalize('NFD')
    .replace(/\p{M}/gu, '')
    .toLowerCase()
    .replace(/[øłđæœß]/g, (letter) => otherLetters[letter] ?? letter);
