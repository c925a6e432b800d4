/** The server's vocabulary, from the schema that its OpenAPI document generates. */

import type { components } from './schema';

type Schemas = components['schemas'];

export type AgentStream = Schemas['AgentStream'];
export type Advice = Schemas['HeadingAdvice'] | Schemas['LatitudeAdvice'];
export type Band = Schemas['Band'];
export type CargoKind = Schemas['CargoKind'];
export type Compass = Schemas['Compass'];
export type Coverage = Schemas['Coverage'];
export type DeviationRow = Schemas['DeviationRow'];
export type DeviationTable = Schemas['DeviationTable'];
export type EnrolmentCode = Schemas['EnrolmentCode'];
export type HeadingRange = Schemas['HeadingRange'];
export type LogbookEntry = Schemas['LogbookEntry'];
export type LogbookKind = Schemas['LogbookKind'];
export type Me = Schemas['Me'];
export type Model = Schemas['Model'];
export type ModelVersion = Schemas['ModelVersion'];
export type NewEntry = Schemas['NewEntry'];
export type NewVessel = Schemas['NewVessel'];
export type ParameterName = keyof Schemas['Identifiable'];
export type SailNext = Schemas['SailNext'];
export type Sample = Schemas['Sample'];
export type Vessel = Schemas['Vessel'];
export type Worst = NonNullable<Vessel['worst']>;
