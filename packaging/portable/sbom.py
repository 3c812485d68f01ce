# SPDX-License-Identifier: MIT
"""Writes the list of what is linked into a release in the format of CycloneDX 1.6, and checks it against its schema.

sbom.py <version> <file>: standard input has a line for each: part, name, package URL, licence, with tabs between them.
"""
import collections
import datetime
import os
import sys
import uuid

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import Property
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL

version, path = sys.argv[1:]
parts = collections.defaultdict(set)
for line in sys.stdin.read().splitlines():
    part, *linked = line.split("\t")
    parts[tuple(linked)].add(part)
if not parts:
    sys.exit("sbom.py: nothing is linked in")

licences = LicenseFactory()
root = Component(
    name="g4lidar", version=version, type=ComponentType.APPLICATION, bom_ref="g4lidar",
    licenses=[licences.make_from_string("MIT")],
)
bom = Bom(serial_number=uuid.uuid5(uuid.NAMESPACE_URL, "g4lidar " + version))
bom.metadata.component = root
bom.metadata.timestamp = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
for (name, url, licence), where in sorted(parts.items()):
    purl = PackageURL.from_string(url)
    bom.components.add(
        Component(
            name=name, version=purl.version, type=ComponentType.LIBRARY, purl=purl, bom_ref=url,
            licenses=[licences.make_from_string(licence)],
            properties=[Property(name="g4lidar:linked-into", value=part) for part in where],
        )
    )
bom.register_dependency(root, bom.components)
text = JsonV1Dot6(bom).output_as_string(indent=2)
if problem := JsonStrictValidator(SchemaVersion.V1_6).validate_str(text):
    sys.exit(f"sbom.py: {problem}")
with open(path, "w") as file:
    file.write(text + "\n")
