"""The legal time of ports: the IANA zone of a UN/LOCODE by its country, subdivision and place.

A country of one zone has that of tzdb's zone.tab. Elsewhere the subdivision that UNECE names
decides, and where a subdivision is parted, a line on the map; where UNECE names none, that
of the nearest port of the country which has one. Positions of UNECE's list are
sometimes far off, so that a place decides only where nothing else does. Nobody's law holds
in international waters: there it is the nautical zone of the longitude.
"""
from math import cos, hypot, radians


def read(path):
    """Zones by country, each with its latitude and longitude, of a zone.tab."""
    zones = {}
    for line in open(path, encoding="utf-8"):
        if not line.startswith("#"):
            country, place, zone, *_ = line.rstrip("\n").split("\t")
            at = max(place.rfind("+"), place.rfind("-"))
            zones.setdefault(country, []).append((zone, degrees(place[:at]), degrees(place[at:])))
    return zones


def degrees(text):
    """±DDMM, ±DDDMM or with seconds."""
    digits = text[1:]
    seconds = digits[-2:] if len(digits) >= 6 else "0"
    digits = digits[:-2] if len(digits) >= 6 else digits
    size = int(digits[:-2]) + int(digits[-2:]) / 60 + int(seconds) / 3600
    return -size if text[0] == "-" else size


def of_states(table):
    return {state: zone for zone, states in table.items() for state in states.split()}


AMERICA, ASIA = "America/", "Asia/"

# Which zone a subdivision keeps.
STATES = {
    "AR": of_states({
        AMERICA + "Argentina/Buenos_Aires": "B C",
        AMERICA + "Argentina/Cordoba": "H N E P S G X",
        AMERICA + "Argentina/Salta": "A L Q R", AMERICA + "Argentina/Jujuy": "Y",
        AMERICA + "Argentina/Tucuman": "T", AMERICA + "Argentina/Catamarca": "K U",
        AMERICA + "Argentina/La_Rioja": "F", AMERICA + "Argentina/San_Juan": "J",
        AMERICA + "Argentina/San_Luis": "D", AMERICA + "Argentina/Rio_Gallegos": "Z",
        AMERICA + "Argentina/Ushuaia": "V"}) | {"M": AMERICA + "Argentina/Mendoza"},
    "AU": of_states({
        "Australia/Brisbane": "QLD", "Australia/Adelaide": "SA", "Australia/Perth": "WA",
        "Australia/Sydney": "NSW ACT", "Australia/Melbourne": "VIC",
        "Australia/Hobart": "TAS", "Australia/Darwin": "NT"}),
    "BR": of_states({
        AMERICA + "Belem": "PA AP", AMERICA + "Fortaleza": "MA PI CE RN PB",
        AMERICA + "Recife": "PE", AMERICA + "Araguaina": "TO", AMERICA + "Maceio": "AL SE",
        AMERICA + "Bahia": "BA", AMERICA + "Sao_Paulo": "GO DF MG ES RJ SP PR SC RS",
        AMERICA + "Campo_Grande": "MS", AMERICA + "Cuiaba": "MT",
        AMERICA + "Porto_Velho": "RO", AMERICA + "Boa_Vista": "RR",
        AMERICA + "Manaus": "AM", AMERICA + "Rio_Branco": "AC"}),
    "CA": of_states({
        AMERICA + "St_Johns": "NL", AMERICA + "Halifax": "NS PE", AMERICA + "Moncton": "NB",
        AMERICA + "Toronto": "QC ON", AMERICA + "Winnipeg": "MB", AMERICA + "Regina": "SK",
        AMERICA + "Edmonton": "AB", AMERICA + "Inuvik": "NT", AMERICA + "Iqaluit": "NU",
        AMERICA + "Vancouver": "BC", AMERICA + "Whitehorse": "YT"}),
    "CD": {"": "Africa/Kinshasa"},
    "CL": of_states({
        AMERICA + "Santiago": "AP TA AN AT CO VS RM LI ML NB BI AR LR LL",
        AMERICA + "Coyhaique": "AI", AMERICA + "Punta_Arenas": "MA"}),
    # The law is Beijing's in Xinjiang too.
    "CN": {"": ASIA + "Shanghai"},
    "DE": {"": "Europe/Berlin"},
    "EC": {"W": "Pacific/Galapagos", "": AMERICA + "Guayaquil"},
    "ES": {"GC": "Atlantic/Canary", "TF": "Atlantic/Canary", "CE": "Africa/Ceuta",
           "ML": "Africa/Ceuta", "": "Europe/Madrid"},
    "FM": of_states({"Pacific/Chuuk": "YAP TRK", "Pacific/Pohnpei": "PNI",
                     "Pacific/Kosrae": "KSA"}),
    "GL": {"": AMERICA + "Nuuk"},
    "ID": of_states({
        ASIA + "Jakarta": "AC BB BE BT JA JB JI JK JT KR LA RI SB SS SU YO",
        ASIA + "Pontianak": "KB KT",
        ASIA + "Makassar": "BA GO KI KS KU NB NT SA SG SN SR ST",
        ASIA + "Jayapura": "MA MU PA PB"}),
    "KI": {"G": "Pacific/Tarawa", "P": "Pacific/Kanton", "L": "Pacific/Kiritimati"},
    "MX": of_states({
        AMERICA + "Cancun": "ROO", AMERICA + "Merida": "CAM YUC",
        AMERICA + "Monterrey": "COA DUR NLE TAM", AMERICA + "Chihuahua": "CHH",
        AMERICA + "Mazatlan": "BCS NAY SIN", AMERICA + "Hermosillo": "SON",
        AMERICA + "Tijuana": "BCN"}) | {"": AMERICA + "Mexico_City"},
    "MY": of_states({ASIA + "Kuching": "12 13 15"}) | {"": ASIA + "Kuala_Lumpur"},
    "NZ": {"CIT": "Pacific/Chatham", "": "Pacific/Auckland"},
    "PF": {"": "Pacific/Tahiti"},
    "PG": {"NSB": "Pacific/Bougainville", "": "Pacific/Port_Moresby"},
    "PT": {"20": "Atlantic/Azores", "30": "Atlantic/Madeira", "": "Europe/Lisbon"},
    "RU": of_states({
        "Europe/Kaliningrad": "KGD",
        "Europe/Moscow": "AD ARK BEL BRY CE DA IN IVA KB KC KDA KL KLU KO KOS KR KRS LEN LIP ME "
                         "MO MOS MOW MUR NEN NGR NIZ ORL PNZ PSK ROS RYA SE SMO SPE STA TA TAM "
                         "TUL TVE VLA VLG VOR YAR",
        "Europe/Kirov": "KIR", "Europe/Astrakhan": "AST", "Europe/Saratov": "SAR",
        "Europe/Ulyanovsk": "ULY", "Europe/Samara": "SAM UD",
        ASIA + "Yekaterinburg": "BA CHE KGN KHM ORE PER SVE TYU YAN", ASIA + "Omsk": "OMS",
        ASIA + "Novosibirsk": "NVS", ASIA + "Barnaul": "AL ALT", ASIA + "Tomsk": "TOM",
        ASIA + "Novokuznetsk": "KEM", ASIA + "Krasnoyarsk": "KK KYA TY",
        ASIA + "Irkutsk": "BU IRK", ASIA + "Chita": "ZAB", ASIA + "Yakutsk": "AMU SA",
        ASIA + "Vladivostok": "KHA PRI YEV", ASIA + "Magadan": "MAG",
        ASIA + "Sakhalin": "SAK", ASIA + "Kamchatka": "KAM", ASIA + "Anadyr": "CHU"})
        | {"VLG": "Europe/Volgograd"},
    "UA": {"40": "Europe/Simferopol", "43": "Europe/Simferopol", "": "Europe/Kyiv"},
    "US": of_states({
        AMERICA + "New_York": "CT DC DE FL GA MA MD ME NC NH NJ NY OH PA RI SC VA VT WV",
        AMERICA + "Detroit": "MI", AMERICA + "Indiana/Indianapolis": "IN",
        AMERICA + "Kentucky/Louisville": "KY",
        AMERICA + "Chicago": "AL AR IA IL KS LA MN MO MS ND NE OK SD TN TX WI",
        AMERICA + "Denver": "CO MT NM UT WY", AMERICA + "Boise": "ID",
        AMERICA + "Phoenix": "AZ", AMERICA + "Los_Angeles": "CA NV OR WA",
        AMERICA + "Anchorage": "AK", "Pacific/Honolulu": "HI"}),
}

# Which subdivision a port is in that UNECE puts in none, and the nearest port in another.
STATE_OF = {
    "IDPGM": "ST", "IDPGA": "JI", "IDSEP": "JI", "IDSUK": "JB",
    "MXCAT": "CAM", "MXLTO": "BCS", "MXPCM": "ROO", "MXTAK": "CAM",
    "RUDKS": "KYA", "RUHTG": "KYA", "RUKRA": "KYA", "RUKUF": "SAM", "RUMCX": "DA",
    "RUMAS": "CHE", "RUCHB": "CHE", "RUSIZ": "KHA", "RUSSK": "KGD", "RUTOI": "SAM",
    "RUUKK": "KAM", "CDMKL": "east",
}
# Overseas, under the code of the country they belong to.
ZONE_OF = {"NLSAB": AMERICA + "Kralendijk", "GBANO": AMERICA + "Tortola"}
STATES["CD"]["east"] = "Africa/Lubumbashi"

# Where another zone begins within a subdivision, or within a country whose ports UNECE puts
# in none: of the lines whose test holds the first decides.
PARTS = {
    "AU-NSW": [(lambda n, e: e > 155, "Australia/Lord_Howe"),
               (lambda n, e: e < 142, "Australia/Broken_Hill")],
    "AU-TAS": [(lambda n, e: n < -50, "Antarctica/Macquarie")],
    "AU-WA": [(lambda n, e: e > 125.5 and n < -30, "Australia/Eucla")],
    # West of the line from Tabatinga to Porto Acre.
    "BR-AM": [(lambda n, e: n < -4.2 and e < -69.84 - (n + 4.23) * 0.45, AMERICA + "Eirunepe")],
    "BR-PA": [(lambda n, e: e < -54, AMERICA + "Santarem")],
    "BR-PE": [(lambda n, e: e > -33, AMERICA + "Noronha")],
    "CA-BC": [(lambda n, e: e > -116.6 and n < 52, AMERICA + "Edmonton"),
              (lambda n, e: e > -122.5 and n > 55, AMERICA + "Dawson_Creek")],
    # The southeast of Labrador keeps Newfoundland's time.
    "CA-NL": [(lambda n, e: n > 53.55 or n > 52 and e < -58, AMERICA + "Goose_Bay")],
    "CA-NU": [(lambda n, e: n < 66 and -87 < e < -80, AMERICA + "Atikokan"),
              (lambda n, e: e > -86, AMERICA + "Iqaluit"),
              (lambda n, e: n < 66.6, AMERICA + "Rankin_Inlet"),
              (lambda n, e: n > 73, AMERICA + "Resolute"),
              (lambda n, e: True, AMERICA + "Cambridge_Bay")],
    "CA-ON": [(lambda n, e: e < -90, AMERICA + "Winnipeg")],
    # The Magdalen Islands, and the shore east of the Natashquan.
    "CA-QC": [(lambda n, e: n < 48 and e > -62.6, AMERICA + "Halifax"),
              (lambda n, e: n > 49.5 and e > -61.75, AMERICA + "Blanc-Sablon")],
    "CL": [(lambda n, e: e < -100, "Pacific/Easter")],
    "ES-": [(lambda n, e: n < 30, "Atlantic/Canary"), (lambda n, e: n < 35.95, "Africa/Ceuta")],
    "GL": [(lambda n, e: n > 75 and e < -60, AMERICA + "Thule"),
           (lambda n, e: n > 75 and e > -30, AMERICA + "Danmarkshavn"),
           (lambda n, e: n > 69.5 and e > -30, AMERICA + "Scoresbysund")],
    "KI-": [(lambda n, e: e > 0, "Pacific/Tarawa"), (lambda n, e: e > -165, "Pacific/Kiritimati"),
            (lambda n, e: True, "Pacific/Kanton")],
    "MX-NAY": [(lambda n, e: n < 20.9, AMERICA + "Bahia_Banderas")],
    "MX-TAM": [(lambda n, e: n > 25.6, AMERICA + "Matamoros")],
    "MY-": [(lambda n, e: e > 108, ASIA + "Kuching")],
    "NZ": [(lambda n, e: e < -170, "Pacific/Chatham")],
    "PF": [(lambda n, e: n > -11.5, "Pacific/Marquesas"),
           (lambda n, e: n < -20 and e > -136, "Pacific/Gambier")],
    # The coast of Yamal, which UNECE puts in the Nenets district.
    "RU-NEN": [(lambda n, e: e > 65, ASIA + "Yekaterinburg")],
    "RU-SA": [(lambda n, e: e > 147, ASIA + "Srednekolymsk"),
              (lambda n, e: n < 73 and e > 133, ASIA + "Ust-Nera")],
    "US-AK": [(lambda n, e: n < 54 and (e < -169.5 or e > 0), AMERICA + "Adak")],
    # West of the Apalachicola, but for the coast of Gulf County.
    "US-FL": [(lambda n, e: e < -85 and not (n < 29.95 and e > -85.45), AMERICA + "Chicago")],
    "US-ID": [(lambda n, e: n > 45.5, AMERICA + "Los_Angeles")],
    # Around Gary and around Evansville.
    "US-IN": [(lambda n, e: n > 40.74 and e < -86.5 and not (n < 41.17 and e > -86.93),
               AMERICA + "Chicago"),
              (lambda n, e: n < 38.5 and e < -86.45, AMERICA + "Chicago")],
    "US-KS": [(lambda n, e: e < -101.39, AMERICA + "Denver")],
    "US-KY": [(lambda n, e: e < -86.25 or n < 37.4 and e < -85.6, AMERICA + "Chicago")],
    "US-MI": [(lambda n, e: n < 46.25 and e < -87.6 or n < 45.75 and e < -87.2
               or n < 46.42 and e < -88.12, AMERICA + "Menominee")],
    "US-ND": [(lambda n, e: n < 47.6 and e < -101.3, AMERICA + "Denver")],
    "US-NE": [(lambda n, e: e < -101, AMERICA + "Denver")],
    "US-OR": [(lambda n, e: n < 44.45 and e > -118.2, AMERICA + "Boise")],
    "US-SD": [(lambda n, e: e < -100.3, AMERICA + "Denver")],
    "US-TN": [(lambda n, e: e > -85.45, AMERICA + "New_York")],
    "US-TX": [(lambda n, e: e < -104.9, AMERICA + "Denver")],
}


def zones_of(ports, known):
    """The zone of each port: ports are (subdivision, latitude, longitude) by code."""
    states = {code: STATE_OF.get(code, state) for code, (state, *_) in ports.items()}
    found = {code: by_state(code, states[code], *ports[code][1:], known) for code in ports}
    for code in [code for code, zone in found.items() if zone is None]:
        same = [other for other in ports
                if other[:2] == code[:2] and by_table(other, states[other]) is not None]
        found[code] = found[min(same, key=lambda other: apart(ports[code], ports[other]))]
    return found


def by_state(code, state, lat, lon, known):
    country = code[:2]
    zones = known.get(country)
    if code in ZONE_OF:
        return ZONE_OF[code]
    if zones is None:
        ahead = round(lon / 15)
        return f"Etc/GMT{-ahead:+d}" if ahead else "Etc/GMT"
    if len(zones) == 1:
        return zones[0][0]
    for place in (f"{country}-{state}", country):
        for holds, zone in PARTS.get(place, []):
            if holds(lat, lon):
                return zone
    if country in STATES:
        return by_table(code, state)
    return min(zones, key=lambda zone: apart((None, lat, lon), zone))[0]


def by_table(code, state):
    table = STATES.get(code[:2], {})
    return table.get(state, table.get(""))


def apart(one, other):
    (_, lat, lon), (_, n, e) = one, other
    return hypot(lat - n, ((lon - e + 180) % 360 - 180) * cos(radians((lat + n) / 2)))
