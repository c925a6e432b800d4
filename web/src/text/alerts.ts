/** Alerts: what they say, and what is done about them. */

import { translate } from './language';

export const alerts = translate('alerts', {
  lead: 'What someone should know of or act on. An alert clears itself when its cause is over.',
  unacknowledged: (n: number) => (n === 0 ? 'acknowledged' : `${n} to acknowledge`),
  emptyTitle: 'Nothing to see to',
  empty: 'No vessel has an open alert.',
  since: (when: string) => `since ${when}`,
  todo: 'What to do',
  evidence: 'What shows it',
  acknowledged: (who: string, when: string) => `Acknowledged by ${who}, ${when}`,
  cleared: (who: string | null, when: string) =>
    who === null ? `Over since ${when}` : `Cleared by ${who}, ${when}`,
  ordered: (port: string, on: string) => `Adjustment ordered: ${port}, ${on}`,
  acknowledge: 'Acknowledge',
  note: 'Note',
  clear: 'Clear',
  clearReason: 'Why it is over',
  clearMissing: 'Say why it is over.',
  confirmAcknowledge: 'Acknowledge the alert',
  confirmClear: 'Clear the alert',
  saidAcknowledged: 'The alert is acknowledged.',
  saidCleared: 'The alert is cleared.',
  handling: {
    assigned: (name: string) => `Assigned to ${name}`,
    unassigned: 'Nobody is assigned',
    assign: 'Assign to me',
    unassign: 'Unassign me',
    snoozed: (until: string) => `snoozed until ${until}`,
    snooze: (days: number) =>
      days === 1
        ? 'Snooze for a day'
        : days === 7
          ? 'Snooze for a week'
          : `Snooze for ${days} days`,
    wake: 'End the snooze',
    comments: 'Comments',
    none: 'No comment yet.',
    comment: 'Comment',
    commentMissing: 'Write a comment.',
    say: 'Add the comment',
    said: {
      assigned: 'The alert is assigned to you.',
      unassigned: 'The alert is assigned to nobody.',
      snoozed: 'The alert is snoozed.',
      woken: 'The alert is no longer snoozed.',
    },
  },
  acknowledgeAll: (n: number, raised: number) =>
    n === raised ? `Acknowledge all ${n}` : `Acknowledge the first ${n} of ${raised}`,
  acknowledgeAllSure: 'The alerts stay listed, with their causes, as acknowledged.',
  saidAllAcknowledged: (n: number) =>
    n === 1 ? '1 alert is acknowledged.' : `${n} alerts are acknowledged.`,
  filter: {
    search: 'Vessel',
    searchHint: 'Name of the vessel or compass',
    state: 'State',
    anyState: 'Open',
    states: {
      raised: 'To acknowledge',
      acknowledged: 'Acknowledged',
      mine: 'Assigned to me',
      snoozed: 'Snoozed',
    },
    severity: 'Severity',
    anySeverity: 'Any severity',
    cause: 'Cause',
    anyCause: 'Any cause',
    shown: (n: number, all: number) =>
      n === all ? (n === 1 ? '1 open alert' : `${n} open alerts`) : `${n} of ${all} open alerts`,
    criticalHidden: (n: number) =>
      n === 1 ? '1 critical is not shown' : `${n} critical are not shown`,
    noneTitle: 'Nothing fits',
    none: (all: number) =>
      all === 1
        ? 'No open alert fits. There is one: change what is asked for, or show it.'
        : `No open alert fits. There are ${all}: change what is asked for, or show all.`,
    reset: 'Show all alerts',
  },
  noSuch: 'The alert that the link names is neither open nor among those cleared lately.',
  clearedTitle: 'Cleared lately',
  toMail: 'Mail',
  toWebhooks: 'Webhooks',
  toNotifications: 'Notifications',
});
