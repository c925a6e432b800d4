/**
 * The dashboard in the Spanish of Spain. The compiler holds each text against its English one;
 * src/text/es.test.ts holds the words against each other. Nothing here imports anything at run
 * time: it is loaded only by who reads Spanish.
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
