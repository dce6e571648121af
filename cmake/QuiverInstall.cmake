# Installation: headers, library, package configuration.
