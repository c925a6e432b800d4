/** Views of the fleet that a person saved, on the server. */

import type { FleetView } from './api/types';

/** With a view more, in place of one of the same name. */
export function withView(views: readonly FleetView[], view: FleetView): FleetView[] {
  const others = views.filter(({ name }) => name !== view.name);
  return [...others, view].sort((a, b) => a.name.localeCompare(b.name, 'en'));
}
