/** The page of who runs the platform. */

import { translate } from './language';

export const platform = translate('platform', {
  lead: 'The companies on this server. What a fleet’s vessels do is its operator’s business and is not seen here.',
  nameMissing: 'A company needs a name.',
  entering: 'Entering…',
  since: (day: string) => `since ${day}`,
  health: {
    title: 'Health',
    lead: 'Whether requests can be served. Figures for Prometheus are at /metrics.',
    ready: 'Ready.',
    asOf: (when: string) => `Server and database answered at ${when}.`,
    notReady: 'The server answers, but cannot serve requests: its database does not.',
  },
  operators: {
    title: 'Operators',
    lead: 'Companies with a fleet.',
    none: 'No operator yet.',
    name: 'Name of the operator',
    submit: 'Enter the operator',
    entered: (name: string) => `${name} is entered. Invite its first user next.`,
    invite: (name: string) => `Invite an admin of ${name}`,
  },
  firms: {
    title: 'Adjuster firms',
    lead: 'Companies that adjust compasses.',
    none: 'No firm yet.',
    name: 'Name of the firm',
    submit: 'Enter the firm',
    entered: (name: string) => `${name} is entered. Invite its first adjuster next.`,
    invite: (name: string) => `Invite an adjuster of ${name}`,
  },
  together: {
    title: 'Who works with whom',
    lead: 'An operator may offer its orders to the firms that it works with. Orders that a firm has stay with it.',
    operator: 'Operator',
    firm: 'Firm',
    choose: 'Choose…',
    missing: 'Choose an operator and a firm.',
    submit: 'They work together',
    end: 'They do so no more',
    done: (operator: string, firm: string) => `${operator} works with ${firm}.`,
    ended: (operator: string, firm: string) => `${operator} works with ${firm} no more.`,
  },
});
