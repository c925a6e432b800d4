/** The tags of a vessel. */

interface Server {
  /** A vessel's tags as they are now; none where she is gone from the fleet. */
  find: (vessel: string) => Promise<string[] | undefined>;
  putTags: (vessel: string, tags: string[]) => Promise<unknown>;
}

/**
 * Gives a vessel a tag or takes it from her; whether that changed anything. All her tags are sent:
 * they are asked for just before, so that one given meanwhile stays.
 */
export async function setTag(
  vessel: string,
  tag: string,
  has: boolean,
  { find, putTags }: Server,
): Promise<boolean> {
  const tags = await find(vessel);
  if (!tags || tags.includes(tag) === has) return false;
  await putTags(vessel, has ? [...tags, tag] : tags.filter((known) => known !== tag));
  return true;
}
