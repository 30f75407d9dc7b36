# SPDX-License-Identifier: GPL-3.0-or-later
# A Modbus device that is not ours: pymodbus_server.py PORT tcp|rtu. Holding register r holds r, input register r 10000 + r.
import sys
from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartTcpServer
from pymodbus.transaction import ModbusRtuFramer, ModbusSocketFramer


def block(value):
    return ModbusSequentialDataBlock(0, [value(i) for i in range(1000)])


device = ModbusSlaveContext(co=block(lambda i: i % 3 == 0), di=block(lambda i: i % 3 == 1), hr=block(lambda i: i),
                            ir=block(lambda i: 10000 + i), zero_mode=True)
StartTcpServer(context=ModbusServerContext(slaves=device, single=True), address=("127.0.0.1", int(sys.argv[1])),
               framer=ModbusRtuFramer if sys.argv[2] == "rtu" else ModbusSocketFramer)
