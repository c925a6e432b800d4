/** The server's vocabulary, from the schema that its OpenAPI document generates. */

import type { components } from './schema';

type Schemas = components['schemas'];

export type AgentStream = Schemas['AgentStream'];
export type Advice = Schemas['HeadingAdvice'] | Schemas['LatitudeAdvice'];
export type Alert = Schemas['Alert'];
export type AlertCause = Schemas['AlertCause'];
export type Band = Schemas['Band'];
export type CargoKind = Schemas['CargoKind'];
export type CardWithdrawn = Schemas['CardWithdrawn'];
export type Caution = Schemas['Caution'];
export type Change = Schemas['Change'];
export type ChangeCause = Schemas['ChangeCause'];
export type Compass = Schemas['Compass'];
export type Coverage = Schemas['Coverage'];
export type DeviationCard = Schemas['DeviationCard'];
export type DeviationRow = Schemas['DeviationRow'];
export type DeviationTable = Schemas['DeviationTable'];
export type Delivery = Schemas['Delivery'];
export type EnrolmentCode = Schemas['EnrolmentCode'];
export type Epoch = Schemas['Epoch'];
export type HeadingRange = Schemas['HeadingRange'];
export type LogbookEntry = Schemas['LogbookEntry'];
export type LogbookKind = Schemas['LogbookKind'];
export type MadeWebhook = Schemas['MadeWebhook'];
export type MailRecipient = Schemas['MailRecipient'];
export type Me = Schemas['Me'];
export type MessageKind = Schemas['MessageKind'];
export type Model = Schemas['Model'];
export type ModelVersion = Schemas['ModelVersion'];
export type NewEntry = Schemas['NewEntry'];
export type NewMailRecipient = Schemas['NewMailRecipient'];
export type NewVessel = Schemas['NewVessel'];
export type NewWebhook = Schemas['NewWebhook'];
export type ParameterName = keyof Schemas['Identifiable'];
export type References = Schemas['References'];
export type LeftOut = Schemas['LeftOut'];
export type Refusal = Schemas['Refusal'];
export type SailNext = Schemas['SailNext'];
export type Sample = Schemas['Sample'];
export type Severity = Schemas['Severity'];
export type Timeline = Schemas['Timeline'];
export type Vessel = Schemas['Vessel'];
export type Webhook = Schemas['Webhook'];
export type Worst = NonNullable<Vessel['worst']>;
