/**
 * Every English text that the dashboard shows, in one catalogue: `import * as text`.
 * A text with a value in it is a function; values come in already written by
 * `format.ts`. A file is loaded with the pages that show its texts, so what only one
 * page shows has a file of its own.
 */

export * from './alerts';
export * from './audit';
export * from './azimuths';
export * from './berth';
export * from './binnacles';
export * from './changes';
export * from './common';
export * from './deviation';
export * from './fields';
export * from './finder';
export * from './firms';
export * from './fleet';
export * from './foretold';
export * from './formats';
export * from './help';
export * from './limits';
export * from './mail';
export * from './needs';
export * from './new-order';
export * from './notifications';
export * from './offers';
export * from './orders';
export * from './papers';
export * from './platform';
export * from './reports';
export * from './schedule';
export * from './settings';
export * from './signing';
export * from './start';
export * from './trust';
export * from './vessel';
export * from './vessels';
export * from './words';
